"""This package tests the compiler: kernels, digests, the cache of compiled code, threads."""
