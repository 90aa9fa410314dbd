// How a source file compiles its inner loops once for each InstructionSet and chooses among them when it runs, by
// Highway. Such a file FILE.cpp reads
//
//   #undef HWY_TARGET_INCLUDE
//   #define HWY_TARGET_INCLUDE "module/FILE.cpp"
//   #include "common/vector_dispatch.h"
//
//   HWY_BEFORE_NAMESPACE();
//   namespace saw_ndt::internal { namespace HWY_NAMESPACE { namespace {
//   ... what is compiled for each instruction set, in terms of Highway or as plain loops over arrays ...
//   } } }
//   HWY_AFTER_NAMESPACE();
//
//   #if HWY_ONCE
//   namespace saw_ndt::internal {
//   HWY_EXPORT(loop);
//   ... the rest, which calls SAW_NDT_DISPATCH(loop)(arguments) ...
//   }
//   #endif
//
// What is included in between the namespaces must be light: code of other headers that is compiled there for a greater
// instruction set could be linked into code for a lesser one.

#include "common/instruction_set_limit.h"

// No include guard: the file is read anew for each set.
#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

#undef SAW_NDT_DISPATCH
/// The version of an exported function for the instruction set in use.
#define SAW_NDT_DISPATCH(function) (::saw_ndt::internal::obeyInstructionSetLimit(), HWY_DYNAMIC_DISPATCH(function))
