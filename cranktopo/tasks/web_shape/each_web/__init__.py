"""Every distinct web of a shaft with dimensions of its own, under the loads that it has in the shaft."""
