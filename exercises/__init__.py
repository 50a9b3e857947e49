"""The exercises, and the kit that asks, measures and judges."""
