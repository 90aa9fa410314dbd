# What every target of this project is built with: the language level, and warnings as errors on our own code alone.
function(saw_ndt_set_up_target target)
  target_compile_features(${target} PUBLIC cxx_std_17)
  # Without extensions the language level is on the command line, where clang-tidy, whose default is older, reads it too.
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror)
  if(CMAKE_CXX_COMPILER_ID MATCHES Clang)
    # PCL_ADD_POINT4D, which a point type of one's own needs, is such a struct.
    target_compile_options(${target} PRIVATE -Wno-gnu-anonymous-struct -Wno-nested-anon-types)
  endif()
endfunction()

# For targets whose files include common/vector_dispatch.h.
function(saw_ndt_use_vector_dispatch target)
  target_link_libraries(${target} PRIVATE hwy::hwy)
  # Four sets of instructions are enough: what every x86-64 has, SSE4, AVX2, AVX-512. Elsewhere vectors must have a size
  # that is known when they are compiled, which SVE's have not.
  target_compile_definitions(${target} PRIVATE HWY_DISABLED_TARGETS=\(HWY_SSSE3|HWY_AVX3_DL|HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128\))
  target_include_directories(${target} PRIVATE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>)
endfunction()

# saw_ndt_add_test(NAME SOURCE...): a GoogleTest program, each of its tests known to CTest by its own name.
function(saw_ndt_add_test name)
  add_executable(${name} ${ARGN})
  saw_ndt_set_up_target(${name})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/test)
  target_compile_definitions(${name} PRIVATE SAW_NDT_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  target_link_libraries(${name} PRIVATE saw_ndt::saw_ndt GTest::gtest_main)
  gtest_discover_tests(${name} PROPERTIES TIMEOUT 600 DISCOVERY_TIMEOUT 60)
endfunction()
