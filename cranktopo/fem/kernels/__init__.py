"""The two products that solves spend their time in, as machine code for the processor at hand.

XLA keeps the sums of a product in memory between its stages; here they stay in registers. The code is
written for LLVM with llvmlite, compiled in a tenth of a second when a program first needs it, and called by
compiled JAX programs as foreign functions. On other devices, and where it cannot be had, the JAX code of
`fem.operator` and `fem.galerkin` does the same; tests hold one against the other.
"""
