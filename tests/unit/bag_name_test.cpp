// Names of bags: what may be part of one, and which ones the recorder takes for its own.
#include "bag_name.hpp"

#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace {

using threelink_tasks::bag_name;
using threelink_tasks::is_bag_name;
using threelink_tasks::is_plain_name;

constexpr char kDate[] = "2026-01-31-23-59-59";

TEST(BagName, PlainNamesAreLettersDigitsAndTwoSigns) {
  for (const char* name : {"pursuit", "clicked_point", "a", "My-Task_2", "0"})
    EXPECT_TRUE(is_plain_name(name)) << name;
  EXPECT_TRUE(is_plain_name(std::string(64, 'x')));
  for (const std::string name : {"", "../outside", "a/b", "a,b", "a\nb", "a b", "a.b", "\"a\"",
                                 "caf\xc3\xa9", "~", "a\\b", "$x"})
    EXPECT_FALSE(is_plain_name(name)) << name;
  EXPECT_FALSE(is_plain_name(std::string("a\0b", 3)));
  EXPECT_FALSE(is_plain_name(std::string(65, 'x')));
}

TEST(BagName, AreMadeOfPlainNamesOnly) {
  EXPECT_EQ(bag_name("pursuit", kDate, 7), "pursuit_2026-01-31-23-59-59_ep0007.bag");
  EXPECT_EQ(bag_name("a_b", kDate, 4294967295u), "a_b_2026-01-31-23-59-59_ep4294967295.bag");
  EXPECT_THROW(bag_name("../outside", kDate, 1), std::invalid_argument);
  EXPECT_THROW(bag_name("", kDate, 1), std::invalid_argument);
}

TEST(BagName, OwnBagsAreRecognised) {
  EXPECT_TRUE(is_bag_name(bag_name("pursuit", kDate, 1)));
  EXPECT_TRUE(is_bag_name(bag_name("my_ep0001", kDate, 12345)));
  EXPECT_TRUE(is_bag_name("pursuit_2026-01-31-23-59-59_ep0001_recovered.bag"));
  for (const char* name :
       {"", ".bag", "something.bag", "../pursuit_2026-01-31-23-59-59_ep0001.bag",
        "/tmp/pursuit_2026-01-31-23-59-59_ep0001.bag", "pursuit_2026-01-31-23-59-59_ep001.bag",
        "pursuit_2026-01-31-23-59-59_ep0001.bag.active", "_2026-01-31-23-59-59_ep0001.bag",
        "pursuit_2026-01-31-23-59-5x_ep0001.bag", "pursuit-2026-01-31-23-59-59_ep0001.bag",
        "pursuit_2026-01-31-23-59-59_ep00001234567.bag", "2026-01-31-23-59-59_ep0001.bag",
        "pursuit_2026-01-31-23-59-59_ep0001.BAG", "a b_2026-01-31-23-59-59_ep0001.bag"})
    EXPECT_FALSE(is_bag_name(name)) << name;
}

}  // namespace
