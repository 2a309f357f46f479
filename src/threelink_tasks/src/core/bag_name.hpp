// What the recorder calls its files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace threelink_tasks {

constexpr std::size_t kMostNameLetters = 64;

// Whether text from a message may be part of a file's name or of a row: letters, digits, - and _.
bool is_plain_name(std::string_view text);

// TASK_DATE_epNNNN.bag; date: YYYY-mm-dd-HH-MM-SS. Throws std::invalid_argument if the task has no
// plain name.
std::string bag_name(const std::string& task, const std::string& date, std::uint32_t episode);

// Whether a file is named as the recorder names its bags, those that it recovers among them.
bool is_bag_name(std::string_view name);

}  // namespace threelink_tasks
