# The library saw_ndt_mpi and the app saw_ndt_build_map_mpi, where MPI and Boost.MPI are found, unless the option
# SAW_NDT_WITH_MPI is off. Nothing else needs them.
option(SAW_NDT_WITH_MPI "Build saw_ndt_build_map_mpi, where MPI and Boost.MPI are there" ON)
if(SAW_NDT_WITH_MPI)
  find_package(MPI QUIET COMPONENTS CXX)
  find_package(Boost 1.71 QUIET OPTIONAL_COMPONENTS mpi serialization)
  if(TARGET MPI::MPI_CXX AND TARGET Boost::mpi AND TARGET Boost::serialization)
    add_subdirectory(${PROJECT_SOURCE_DIR}/src/mpi)
  else()
    message(STATUS "Without MPI (libopenmpi-dev, libboost-mpi-dev): saw_ndt_build_map_mpi is left out, with its tests")
  endif()
endif()
