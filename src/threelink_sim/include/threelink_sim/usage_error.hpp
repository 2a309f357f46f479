/// @file
/// Errors that the user can correct, and the part of their text that peers may read.
#pragma once

#include <stdexcept>
#include <string>

namespace threelink_sim {

/// An error that the user has to correct. A program prints what() and exits with 2.
///
/// what() may quote the faulty file. A peer that names a file over a topic, a service or an action
/// may lack permission to read it: for_peers() gives the error without the content of the file.
class UsageError : public std::runtime_error {
 public:
  /// For a text that does not quote a file.
  explicit UsageError(const std::string& what) : UsageError(what, what) {}
  UsageError(const std::string& what, const std::string& for_peers)
      : std::runtime_error(what), for_peers_(for_peers) {}

  const std::string& for_peers() const noexcept { return for_peers_; }

 private:
  std::string for_peers_;
};

/// Text or bytes that do not have the expected format.
class FormatError : public UsageError {
 public:
  using UsageError::UsageError;
};

/// The same error with its place as a prefix.
template <class Error = UsageError>
Error within(const std::string& place, const UsageError& error) {
  return Error(place + ": " + error.what(), place + ": " + error.for_peers());
}

/// The text of an error that may be sent to another node.
inline std::string text_for_peers(const std::exception& error) {
  const auto* usage = dynamic_cast<const UsageError*>(&error);
  return usage ? usage->for_peers() : error.what();
}

}  // namespace threelink_sim
