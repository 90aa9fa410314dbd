# Tests that use the project as others do: from an installed copy by find_package(), core alone and all of it, of static and
# of shared libraries; and by add_subdirectory().
set(consumer_source ${PROJECT_SOURCE_DIR}/test/consumer)
set(consumer_build ${PROJECT_BINARY_DIR}/consumer)
set(consumer_options -DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE} -DCMAKE_C_COMPILER=${CMAKE_C_COMPILER}
                     -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER} -DCMAKE_CXX_FLAGS=${CMAKE_CXX_FLAGS}
                     -DCMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER})

# saw_ndt_add_consumer_tests(KIND INSTALLED_COPY): builds and runs the consumers against an installed copy, which the
# fixture installed_KIND has made.
function(saw_ndt_add_consumer_tests kind installed_copy)
  # A PCL that cannot be found stands for a machine without its headers.
  add_test(NAME consumer.${kind}.core_without_pcl
           COMMAND ${CMAKE_CTEST_COMMAND} --build-and-test ${consumer_source} ${consumer_build}/${kind}_core
                   --build-generator ${CMAKE_GENERATOR} --build-project saw_ndt_consumer
                   --build-options ${consumer_options} -DCMAKE_PREFIX_PATH=${installed_copy} -DCONSUMER_COMPONENTS=core
                                   -DCONSUMER_LANGUAGES=CXX -DCMAKE_DISABLE_FIND_PACKAGE_PCL=ON
                   --test-command core_consumer)
  add_test(NAME consumer.${kind}.all
           COMMAND ${CMAKE_CTEST_COMMAND} --build-and-test ${consumer_source} ${consumer_build}/${kind}_all
                   --build-generator ${CMAKE_GENERATOR} --build-project saw_ndt_consumer
                   --build-options ${consumer_options} -DCMAKE_PREFIX_PATH=${installed_copy}
                   --test-command drop_in_consumer)
  set_tests_properties(consumer.${kind}.core_without_pcl consumer.${kind}.all
                       PROPERTIES FIXTURES_REQUIRED installed_${kind})
endfunction()

if(BUILD_SHARED_LIBS)
  set(own_kind shared)
else()
  set(own_kind static)
endif()
set(installed_copy ${PROJECT_BINARY_DIR}/install_for_consumer)
add_test(NAME consumer.${own_kind}.install
         COMMAND ${CMAKE_COMMAND} --install ${PROJECT_BINARY_DIR} --config $<CONFIG> --prefix ${installed_copy})
set_tests_properties(consumer.${own_kind}.install PROPERTIES FIXTURES_SETUP installed_${own_kind})
saw_ndt_add_consumer_tests(${own_kind} ${installed_copy})

if(NOT BUILD_SHARED_LIBS)
  # The libraries and apps once more as shared ones: a compiler cache makes that a matter of linking.
  set(shared_build ${PROJECT_BINARY_DIR}/shared)
  set(shared_copy ${PROJECT_BINARY_DIR}/install_shared_for_consumer)
  add_test(NAME consumer.shared.build
           COMMAND ${CMAKE_CTEST_COMMAND} --build-and-test ${PROJECT_SOURCE_DIR} ${shared_build}
                   --build-generator ${CMAKE_GENERATOR} --build-project saw_ndt
                   --build-options ${consumer_options} -DBUILD_SHARED_LIBS=ON -DSAW_NDT_BUILD_TESTS=OFF
                                   -DSAW_NDT_BUILD_BENCHMARKS=OFF)
  add_test(NAME consumer.shared.install
           COMMAND ${CMAKE_COMMAND} --install ${shared_build} --config $<CONFIG> --prefix ${shared_copy})
  set_tests_properties(consumer.shared.build PROPERTIES FIXTURES_SETUP built_shared TIMEOUT 1500)
  set_tests_properties(consumer.shared.install PROPERTIES FIXTURES_REQUIRED built_shared FIXTURES_SETUP installed_shared)
  add_test(NAME consumer.shared.app COMMAND ${shared_copy}/bin/saw_ndt_localize -h)
  set_tests_properties(consumer.shared.app PROPERTIES FIXTURES_REQUIRED installed_shared PASS_REGULAR_EXPRESSION
                                                      "Usage: saw_ndt_localize")
  saw_ndt_add_consumer_tests(shared ${shared_copy})
endif()

add_test(NAME consumer.find_package_without_c_says_so
         COMMAND ${CMAKE_COMMAND} -G ${CMAKE_GENERATOR} -S ${consumer_source} -B ${consumer_build}/without_c
                 ${consumer_options} -DCMAKE_PREFIX_PATH=${installed_copy} -DCONSUMER_LANGUAGES=CXX)
set_tests_properties(consumer.find_package_without_c_says_so
                     PROPERTIES FIXTURES_REQUIRED installed_${own_kind} PASS_REGULAR_EXPRESSION "LANGUAGES C CXX")
# Configures and generates, which is where a subdirectory's targets are missed; building would compile the library again.
add_test(NAME consumer.add_subdirectory
         COMMAND ${CMAKE_COMMAND} -G ${CMAKE_GENERATOR} -S ${consumer_source} -B ${consumer_build}/add_subdirectory
                 ${consumer_options} -DSAW_NDT_AS_SUBDIRECTORY=${PROJECT_SOURCE_DIR})

# What is compiled for other vector instructions, as by -march=native, aligns Eigen's types otherwise.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND NOT CMAKE_CXX_FLAGS MATCHES "-m(arch|avx)")
  add_test(NAME consumer.other_alignment_does_not_link
           COMMAND ${CMAKE_CTEST_COMMAND} --build-and-test ${consumer_source} ${consumer_build}/other_alignment
                   --build-generator ${CMAKE_GENERATOR} --build-project saw_ndt_consumer
                   --build-options ${consumer_options} -DCMAKE_CXX_FLAGS=-mavx -DCMAKE_PREFIX_PATH=${installed_copy}
                                   -DCONSUMER_COMPONENTS=core -DCONSUMER_LANGUAGES=CXX)
  set_tests_properties(consumer.other_alignment_does_not_link
                       PROPERTIES FIXTURES_REQUIRED installed_${own_kind}
                                  PASS_REGULAR_EXPRESSION "EigenAlignment<32>::must_be_that_of_the_saw_ndt_library")
endif()
