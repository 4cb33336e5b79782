# Environment of every MPI test: runs as root in containers, oversubscribes, does not bind to one core.
set(SCREE_MPI_ENVIRONMENT
  "OMPI_ALLOW_RUN_AS_ROOT=1;OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1;OMPI_MCA_rmaps_base_oversubscribe=1"
  # the same for Open MPI 5, which starts ranks by PRRTE
  "PRTE_ALLOW_RUN_AS_ROOT=1;PRTE_ALLOW_RUN_AS_ROOT_CONFIRM=1;PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe"
  "PRTE_MCA_hwloc_default_binding_policy=none"
  # more ranks and threads than cores: who waits must not hold the core of the one that is waited for
  "OMPI_MCA_mpi_yield_when_idle=1;OMP_WAIT_POLICY=passive"
  "OMPI_MCA_hwloc_base_binding_policy=none;OMPI_MCA_btl_vader_single_copy_mechanism=none"
  # no search for fast networks: a fifth of a second at each start
  "OMPI_MCA_pml=ob1;OMPI_MCA_btl=self,vader,tcp")

# Saves a quarter of the time to compile a test, which is more than most tests take to run. What they test is compiled as users have it.
function(scree_compile_fast target)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources EXCLUDE REGEX "TARGET_OBJECTS")
  set_source_files_properties(${sources} PROPERTIES COMPILE_OPTIONS "$<$<CONFIG:Release>:-O1>")
endfunction()

# scree_unit_test(NAME name SOURCES ... LIBRARIES ... [LABEL fast|mpi|slow] [RANKS 1 2 4] [ENVIRONMENT name=value ...])
#
# A GoogleTest executable. Without RANKS its tests are registered one by one; with RANKS the whole
# executable runs once for each number of ranks (its main must start MPI).
function(scree_unit_test)
  cmake_parse_arguments(arg "" "NAME;LABEL" "SOURCES;LIBRARIES;RANKS;ENVIRONMENT" ${ARGN})
  if(NOT arg_LABEL)
    if(arg_RANKS)
      set(arg_LABEL mpi)
    else()
      set(arg_LABEL fast)
    endif()
  endif()
  add_executable(${arg_NAME} ${arg_SOURCES})
  scree_compile_fast(${arg_NAME})
  target_link_libraries(${arg_NAME} PRIVATE scree_flags ${arg_LIBRARIES} GTest::gtest)
  if(arg_RANKS)
    foreach(ranks IN LISTS arg_RANKS)
      add_test(NAME ${arg_NAME}.ranks_${ranks}
        COMMAND ${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG} ${ranks} $<TARGET_FILE:${arg_NAME}>)
      set_tests_properties(${arg_NAME}.ranks_${ranks} PROPERTIES
        PROCESSORS ${ranks} TIMEOUT 300 LABELS ${arg_LABEL} ENVIRONMENT "${SCREE_MPI_ENVIRONMENT};OMP_NUM_THREADS=1;${arg_ENVIRONMENT}")
    endforeach()
  else()
    target_link_libraries(${arg_NAME} PRIVATE GTest::gtest_main)
    gtest_discover_tests(${arg_NAME} DISCOVERY_TIMEOUT 60 PROPERTIES LABELS ${arg_LABEL} TIMEOUT 300)
    # gtest_discover_tests would take the list apart and keep its first word
    set(environment_file "${CMAKE_CURRENT_BINARY_DIR}/${arg_NAME}_environment.cmake")
    file(WRITE "${environment_file}" "if(${arg_NAME}_TESTS)
  set_tests_properties(\${${arg_NAME}_TESTS} PROPERTIES ENVIRONMENT \"${SCREE_MPI_ENVIRONMENT};${arg_ENVIRONMENT}\")
endif()
")
    set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES "${environment_file}")
  endif()
endfunction()
