/// @file
/// Errors that somebody has to put right, and what of them may be told to whom.
#pragma once

#include <stdexcept>
#include <string>

namespace threelink_sim {

/// Something that the user has to put right: what() says what, and a program exits with 2.
///
/// what() may quote the file that is wrong. Whoever names a file over a topic, a service or an
/// action may be somebody who may not read it: for_peers() says the same without what the file
/// holds.
class UsageError : public std::runtime_error {
 public:
  /// For a text that quotes no file.
  explicit UsageError(const std::string& what) : UsageError(what, what) {}
  UsageError(const std::string& what, const std::string& for_peers)
      : std::runtime_error(what), for_peers_(for_peers) {}

  const std::string& for_peers() const noexcept { return for_peers_; }

 private:
  std::string for_peers_;
};

/// Text or bytes that are not in the format that they should have.
class FormatError : public UsageError {
 public:
  using UsageError::UsageError;
};

/// The same error with the place where it was found in front of it.
template <class Error = UsageError>
Error within(const std::string& place, const UsageError& error) {
  return Error(place + ": " + error.what(), place + ": " + error.for_peers());
}

// What may be sent to another node.
inline std::string text_for_peers(const std::exception& error) {
  const auto* usage = dynamic_cast<const UsageError*>(&error);
  return usage ? usage->for_peers() : error.what();
}

}  // namespace threelink_sim
