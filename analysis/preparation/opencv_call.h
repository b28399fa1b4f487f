#pragma once

#include <exception>
#include <string>
#include <string_view>

#include "render/base/error.h"

namespace gladstone::inline preparation {

/// Translates the current exception if it is one of OpenCV: to std::bad_alloc if memory is exhausted, otherwise to a
/// DataError of the given code and place, which asks for a report if the code is `internal`. Rethrows other exceptions.
/// @pre called in a catch block
[[noreturn]] void rethrow_opencv_error(ErrorCode code, std::string const& place, std::string_view task);

/// Returns the result of a function that calls OpenCV, whose exceptions are translated.
/// @param code  code of errors other than exhausted memory
/// @param place  place of these errors, such as "image"
/// @param task  completes "OpenCV cannot"
template <class Call>
decltype(auto) call_opencv(ErrorCode code, std::string const& place, std::string_view task, Call const& call) {
  try {
    return call();
  } catch (std::exception const&) {
    rethrow_opencv_error(code, place, task);
  }
}

}  // namespace gladstone::inline preparation
