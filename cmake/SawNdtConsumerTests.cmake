# Tests that use the project as others do: from an installed copy by find_package(), and by add_subdirectory().
set(consumer_source ${PROJECT_SOURCE_DIR}/test/consumer)
set(consumer_build ${PROJECT_BINARY_DIR}/consumer)
set(installed_copy ${PROJECT_BINARY_DIR}/install_for_consumer)
set(consumer_options -DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE} -DCMAKE_C_COMPILER=${CMAKE_C_COMPILER}
                     -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER} -DCMAKE_CXX_FLAGS=${CMAKE_CXX_FLAGS}
                     -DCMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER})

add_test(NAME consumer.install
         COMMAND ${CMAKE_COMMAND} --install ${PROJECT_BINARY_DIR} --config $<CONFIG> --prefix ${installed_copy})
add_test(NAME consumer.find_package
         COMMAND ${CMAKE_CTEST_COMMAND} --build-and-test ${consumer_source} ${consumer_build}/find_package
                 --build-generator ${CMAKE_GENERATOR} --build-project saw_ndt_consumer
                 --build-options ${consumer_options} -DCMAKE_PREFIX_PATH=${installed_copy}
                 --test-command consumer)
add_test(NAME consumer.find_package_without_c_says_so
         COMMAND ${CMAKE_COMMAND} -G ${CMAKE_GENERATOR} -S ${consumer_source} -B ${consumer_build}/without_c
                 ${consumer_options} -DCMAKE_PREFIX_PATH=${installed_copy} -DCONSUMER_LANGUAGES=CXX)
# Configures and generates, which is where a subdirectory's targets are missed; building would compile the library again.
add_test(NAME consumer.add_subdirectory
         COMMAND ${CMAKE_COMMAND} -G ${CMAKE_GENERATOR} -S ${consumer_source} -B ${consumer_build}/add_subdirectory
                 ${consumer_options} -DSAW_NDT_AS_SUBDIRECTORY=${PROJECT_SOURCE_DIR})

set_tests_properties(consumer.install PROPERTIES FIXTURES_SETUP installed_copy)
set_tests_properties(consumer.find_package consumer.find_package_without_c_says_so
                     PROPERTIES FIXTURES_REQUIRED installed_copy)
set_tests_properties(consumer.find_package_without_c_says_so PROPERTIES PASS_REGULAR_EXPRESSION "LANGUAGES C CXX")
