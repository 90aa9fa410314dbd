# What every target of this project is built with: the language level, and warnings, which are errors where this project is
# not a part of another.
option(SAW_NDT_WARNINGS_AS_ERRORS "Treat warnings as errors" ${PROJECT_IS_TOP_LEVEL})

function(saw_ndt_set_up_target target)
  target_compile_features(${target} PUBLIC cxx_std_17)
  # Without extensions the language level is on the command line, where clang-tidy, whose default is older, reads it too.
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
                                           $<$<BOOL:${SAW_NDT_WARNINGS_AS_ERRORS}>:-Werror>)
  if(CMAKE_CXX_COMPILER_ID MATCHES Clang)
    # PCL_ADD_POINT4D, which a point type of one's own needs, is such a struct.
    target_compile_options(${target} PRIVATE -Wno-gnu-anonymous-struct -Wno-nested-anon-types)
  endif()
endfunction()

# saw_ndt_add_library(COMPONENT): the library saw_ndt_COMPONENT, saw_ndt::COMPONENT to those who link it, whose sources the
# folders of its modules add.
function(saw_ndt_add_library component)
  set(target saw_ndt_${component})
  add_library(${target})
  add_library(saw_ndt::${component} ALIAS ${target})
  saw_ndt_set_up_target(${target})
  set_target_properties(${target} PROPERTIES
                        EXPORT_NAME ${component} POSITION_INDEPENDENT_CODE ON VERSION ${PROJECT_VERSION}
                        SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
                        CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON DEFINE_SYMBOL "")
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                              $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>
                                              $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
                                       PRIVATE ${PROJECT_SOURCE_DIR}/src)
endfunction()

# saw_ndt_add_internal_library(NAME SOURCE...): the library saw_ndt_NAME, which serves this project's programs alone and is
# not installed.
function(saw_ndt_add_internal_library name)
  add_library(saw_ndt_${name} STATIC ${ARGN})
  saw_ndt_set_up_target(saw_ndt_${name})
  target_include_directories(saw_ndt_${name} PUBLIC ${PROJECT_SOURCE_DIR}/src)
endfunction()

# For targets whose files include common/vector_dispatch.h.
function(saw_ndt_use_vector_dispatch target)
  target_link_libraries(${target} PRIVATE hwy::hwy)
  # Four sets of instructions are enough: what every x86-64 has, SSE4, AVX2, AVX-512. Elsewhere vectors must have a size
  # that is known when they are compiled, which SVE's have not.
  target_compile_definitions(${target} PRIVATE HWY_DISABLED_TARGETS=\(HWY_SSSE3|HWY_AVX3_DL|HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128\))
  target_include_directories(${target} PRIVATE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>)
endfunction()

# saw_ndt_add_test(NAME SOURCE... [LIBRARIES LIBRARY...] [PROPERTIES NAME VALUE...]): a GoogleTest program, each of its tests
# known to CTest by its own name, with these properties. Tests may look at what is private.
function(saw_ndt_add_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "LIBRARIES;PROPERTIES")
  add_executable(${name} ${arg_UNPARSED_ARGUMENTS})
  saw_ndt_set_up_target(${name})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/test ${PROJECT_SOURCE_DIR}/src)
  target_compile_definitions(${name} PRIVATE SAW_NDT_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  target_link_libraries(${name} PRIVATE ${arg_LIBRARIES} saw_ndt::saw_ndt GTest::gtest_main)
  gtest_discover_tests(${name} PROPERTIES TIMEOUT 600 ${arg_PROPERTIES} DISCOVERY_TIMEOUT 60)
endfunction()
