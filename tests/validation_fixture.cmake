# Read by ctest, after the lists of tests: those that docs/theory/validation.md names run before tools.validation, which
# compares the page with what they obtained.
file(READ ${CMAKE_CURRENT_LIST_DIR}/../docs/theory/validation.md page)
get_cmake_property(variables VARIABLES)
foreach(variable IN LISTS variables)
  if(variable MATCHES "^(scenes|(unit|contract|physics|step)_[a-z]+)_TESTS$")
    foreach(test IN LISTS ${variable})
      string(REGEX REPLACE "<.*" "" name "${test}")  # of a typed test
      string(REGEX REPLACE "\\..*" ".*" suite "${name}")
      string(FIND "${page}" "`${name}`" named)
      string(FIND "${page}" "`${suite}`" suite_named)
      if(named GREATER -1 OR suite_named GREATER -1)
        set_tests_properties("${test}" PROPERTIES FIXTURES_SETUP validation)
      endif()
    endforeach()
  endif()
endforeach()
