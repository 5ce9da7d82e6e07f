/// Typed errors. Every message is one line that names the file, value or shape and the reason.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace relumbre {

/// Root of every error the library throws on purpose. A bug is an assertion, not an Error.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A file that cannot be read, parsed or written: "FILE: reason", or "FILE:LINE: reason".
class FileError : public Error {
 public:
  FileError(std::string_view file, std::string_view reason)
      : Error(std::string(file) + ": " + std::string(reason)) {}
  FileError(std::string_view file, std::size_t line, std::string_view reason)
      : Error(std::string(file) + ":" + std::to_string(line) + ": " + std::string(reason)) {}
};

/// A value outside its documented range.
class ValueError : public Error {
 public:
  using Error::Error;
};

/// An array whose shape is not what the operation needs.
class ShapeError : public Error {
 public:
  using Error::Error;
};

/// The caller's Progress asked long work to stop. Whatever was finished is kept.
class Cancelled : public Error {
 public:
  using Error::Error;
};

}  // namespace relumbre
