"""Products in which solves spend their time, as machine code for the processor at hand.

XLA keeps the sums of a product in memory between its stages; here they stay in registers, and what is done
with the product, such as a step of smoothing, is done while it is in the cache. The code is written for LLVM
with llvmlite, compiled in a tenth of a second when a program first needs it, and called by compiled JAX
programs as foreign functions. On other devices, and where it cannot be had, the JAX code of `numerics.grid`
does the same; tests hold one against the other.
"""
