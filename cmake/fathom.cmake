# How every target of the project is built: one place for the language, the warnings and the labels of tests.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

find_program(FATHOM_CCACHE ccache)
if(FATHOM_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${FATHOM_CCACHE})
endif()

function(fathom_target_defaults target)
  target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR})
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wconversion -Werror)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # GCC 12 reports overlapping copies inside std::string's operator+ that are not there (GCC bug 105651).
    target_compile_options(${target} PRIVATE -Wno-restrict)
  endif()
endfunction()

# For targets that only parse, call and check: optimising them would take most of the build's time and gain nothing.
function(fathom_build_fast target)
  if(CMAKE_BUILD_TYPE STREQUAL "Release" OR FATHOM_AS_RELEASED)
    target_compile_options(${target} PRIVATE -O1)
  endif()
endfunction()

if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
  set(FATHOM_SANITIZED ON)
endif()

# In the folders of the tests, the windows and the command line: under AddressSanitizer these are compiled as in release.
# Faults are looked for in the libraries that do the work; in what only parses, draws, calls and checks, looking would
# double the build.
macro(fathom_compile_as_released)
  if(CMAKE_CXX_FLAGS MATCHES "-fsanitize=address")
    set(CMAKE_CXX_FLAGS "-O3 -DNDEBUG")
    set(FATHOM_AS_RELEASED ON)
  endif()
endmacro()

# fathom_library(<folder> SOURCES ... LINK ...): the static library fathom_<folder>.
function(fathom_library folder)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;LINK")
  add_library(fathom_${folder} STATIC ${arg_SOURCES})
  target_link_libraries(fathom_${folder} PUBLIC ${arg_LINK})
  fathom_target_defaults(fathom_${folder})
endfunction()

# fathom_test(<folder> SOURCES ... LINK ...): the program <folder>_test, one ctest entry per test case.
# Cases whose suite name ends in "Study" are long runs labelled `study` (not run under the sanitizers); all others are
# labelled `ci`.
function(fathom_test folder)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;LINK")
  add_executable(${folder}_test ${arg_SOURCES})
  target_link_libraries(${folder}_test PRIVATE ${arg_LINK} GTest::gtest GTest::gtest_main)
  fathom_target_defaults(${folder}_test)
  fathom_build_fast(${folder}_test)
  if(FATHOM_SANITIZED)
    # To start a program under the sanitizers takes longer than most cases: a few entries share the cases among them.
    set(shares 4)
    math(EXPR last "${shares} - 1")
    foreach(share RANGE ${last})
      add_test(NAME "${folder}_test.${share}" COMMAND ${folder}_test --gtest_brief=1 --gtest_filter=-*Study.*)
      set_tests_properties("${folder}_test.${share}" PROPERTIES LABELS ci TIMEOUT 900 COST 50
        ENVIRONMENT "GTEST_TOTAL_SHARDS=${shares};GTEST_SHARD_INDEX=${share}")
    endforeach()
    return()
  endif()
  include(GoogleTest)
  gtest_discover_tests(${folder}_test TEST_FILTER "-*Study.*" DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS ci TIMEOUT 300)
  gtest_discover_tests(${folder}_test TEST_FILTER "*Study.*" TEST_SUFFIX " (study)" DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS study TIMEOUT 7200)
endfunction()

# fathom_benchmark(<name> SOURCES ... LINK ...): a Google Benchmark program.
function(fathom_benchmark name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;LINK")
  add_executable(${name}_benchmark ${arg_SOURCES})
  target_link_libraries(${name}_benchmark PRIVATE ${arg_LINK} benchmark::benchmark benchmark::benchmark_main)
  fathom_target_defaults(${name}_benchmark)
endfunction()
