#pragma once

/// Marks what a shared library of this project shows to those who link it; everything else is hidden.
#if defined(__GNUC__)
#define SAW_NDT_EXPORT __attribute__((visibility("default")))
#else
#define SAW_NDT_EXPORT
#endif
