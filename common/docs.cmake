# SPDX-License-Identifier: GPL-3.0-or-later
# The target `docs`: Doxygen's pages of the public headers and the READMEs. A public name without a
# comment is an error, and so is a comment or a link that Doxygen cannot follow.
find_package(Doxygen QUIET)
if(NOT DOXYGEN_FOUND)
  message(STATUS "lagrain: no target docs without Doxygen (Debian: doxygen)")
  return()
endif()

set(headers)
foreach(module common scenes dim2 dim3 render)
  if(TARGET lagrain_${module})
    get_target_property(files lagrain_${module} HEADER_SET)
    list(APPEND headers ${files})
  endif()
endforeach()
set(pages README.md common/README.md common/scenes/README.md dim2/README.md dim3/README.md
  render/README.md figures/README.md figures/python/README.md tests/README.md
  .github/CONTRIBUTING.md CHANGELOG.md)

set(DOXYGEN_OUTPUT_DIRECTORY docs)
set(DOXYGEN_USE_MDFILE_AS_MAINPAGE ${PROJECT_SOURCE_DIR}/README.md)
set(DOXYGEN_IMAGE_PATH common dim2 dim3 figures)
set(DOXYGEN_STRIP_FROM_PATH ${PROJECT_SOURCE_DIR})
set(DOXYGEN_JAVADOC_AUTOBRIEF YES)          # the first sentence is the summary
set(DOXYGEN_DISTRIBUTE_GROUP_DOC YES)       # one comment for all members between @{ and @}
set(DOXYGEN_WARN_AS_ERROR FAIL_ON_WARNINGS)
set(DOXYGEN_WARN_IF_INCOMPLETE_DOC NO)      # name and type describe most arguments
set(DOXYGEN_QUIET YES)
# The same pages everywhere: no formula is set by LaTeX, no graph drawn by dot.
set(DOXYGEN_GENERATE_LATEX NO)
set(DOXYGEN_HAVE_DOT NO)
# What needs no page: inner parts, what teaches Eigen about Lanes, comparisons member by member.
set(DOXYGEN_EXCLUDE_SYMBOLS lagrain::detail lagrain::detail::* Eigen Eigen::*)
# Doxygen 1.9 does not follow a link to a heading of another page; the page will do.
set(DOXYGEN_INPUT_FILTER
  "sed -e 's/^.*operator[<=>]*(.*= default//' -e 's/[.]md#[a-z0-9-]*/.md/g'")
doxygen_add_docs(docs ${headers} ${pages} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
  COMMENT "API reference: docs/html/index.html in the build folder")
