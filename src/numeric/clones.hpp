#pragma once

// One source for processors with and without wide vectors; chosen when the program starts, by what the processor has (a name
// of a processor, "arch=…", would leave out all makers but one). No fused multiplication and addition: every processor gives
// the same bits. Sanitizers instrument before that choice is made, so they get the plain one.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define BODESMITH_CLONES __attribute__((target_clones("default", "avx2")))
#else
#define BODESMITH_CLONES
#endif
