// What `status` shows of a training.
#include "status_view.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace {

using namespace threelink_agent;
using threelink_msgs::TrainingStatus;
using threelink_msgs::WorkerReport;

TrainingStatus status() {
  TrainingStatus status;
  status.update = 34;
  status.updates = 100;
  status.episodes = 1360;
  status.steps = 272000;
  status.steps_per_s = 241300;
  status.mean_return = 1.25;
  status.speed = status.success_rate = std::numeric_limits<double>::quiet_NaN();
  status.time_left = 180;
  return status;
}

WorkerReport worker(const std::string& name, std::uint8_t state) {
  WorkerReport worker;
  worker.name = "/threelink/" + name;
  worker.state = state;
  worker.host = "far";
  worker.silence = 0.26;
  worker.episodes = 520;
  worker.leases_lost = 7;
  worker.batches_refused = 8;
  worker.instances = 2;
  return worker;
}

constexpr TerminalSize kLarge{200, 50};

TEST(StatusLineTest, SaysHowFarTheTrainingIs) {
  EXPECT_EQ(status_line(status(), 0.5),
            " 34 %  3 min left  update 34/100  1360 episodes  241.3 k steps/s  return 1.250  "
            "0 workers");
  TrainingStatus later = status();
  later.speed = 0.0129;
  later.success_rate = 0.985;
  later.workers = 2;
  later.worker_reports = {worker("a", WorkerReport::GONE), worker("b", WorkerReport::REFUSED)};
  EXPECT_EQ(status_line(later, 12),
            " 34 %  3 min left  update 34/100  1360 episodes  241.3 k steps/s  return 1.250  "
            "speed 0.01290  success 98.5 %  2 workers, 1 gone, 1 refused  (as of 12 s ago)");
}

TEST(StatusLineTest, KnowsBeginningAndEnd) {
  TrainingStatus first = status();
  first.update = first.episodes = 0;
  first.steps_per_s = 0;
  EXPECT_EQ(status_line(first, 0).substr(0, 13), "  0 %  begins");
  TrainingStatus last = status();
  last.update = 100;
  EXPECT_EQ(status_line(last, 0).substr(0, 15), "100 %  finished");
  last.update = 99;  // not 100 % before it is
  last.updates = 100;
  EXPECT_EQ(status_line(last, 0).substr(0, 5), " 99 %");
}

TEST(StatusScreenTest, HasALineForEachWorker) {
  TrainingStatus training = status();
  training.workers = 1;
  WorkerReport refused = worker("zeta", WorkerReport::REFUSED);
  refused.reason = "it computes other bits";
  training.worker_reports = {worker("alpha", WorkerReport::ALIVE),
                             worker("beta", WorkerReport::GONE), refused};
  const std::vector<std::string> lines = status_screen(training, 0, kLarge);
  ASSERT_EQ(lines.size(), 9u);
  EXPECT_EQ(lines[0], "[##########....................]  34 %  3 min left");
  EXPECT_EQ(lines[1], "update 34/100  1360 episodes  272000 steps  241.3 k steps/s");
  EXPECT_EQ(lines[2], "return 1.250");
  EXPECT_EQ(lines[3], "1 worker, 1 gone, 1 refused");
  EXPECT_EQ(lines[5], "worker  host  state    episodes  heard ago  lost  refused started");
  EXPECT_EQ(lines[6],
            "zeta    far   refused       520      0.3 s     7        8       2  it computes other "
            "bits");
  EXPECT_EQ(lines[7], "beta    far   gone          520      0.3 s     7        8       2");
  EXPECT_EQ(lines[8], "alpha   far   alive         520      0.3 s     7        8       2");
}

TEST(StatusScreenTest, FitsTheTerminal) {
  TrainingStatus training = status();
  for (int i = 0; i < 200; ++i)
    training.worker_reports.push_back(worker("worker_" + std::to_string(i), WorkerReport::ALIVE));
  training.worker_reports[150].state = WorkerReport::GONE;
  for (std::size_t rows : {1, 8, 10, 24, 205, 206, 207, 300}) {
    SCOPED_TRACE(rows);
    const std::vector<std::string> lines = status_screen(training, 0, {40, rows});
    EXPECT_LT(lines.size(), std::max<std::size_t>(rows, 9));
    for (const std::string& line : lines) EXPECT_LT(line.size(), 40u);
    if (rows < 9) continue;
    EXPECT_EQ(lines[6].substr(0, 10), "worker_150");  // what is in trouble is seen
    if (rows >= 207) {
      EXPECT_EQ(lines.size(), 206u);
    } else {
      EXPECT_EQ(lines.back(), "and " + std::to_string(200 - (lines.size() - 7)) + " more");
    }
  }
}

TEST(TerminalTest, DurationsAndBars) {
  EXPECT_EQ(duration(119.4), "119 s");
  EXPECT_EQ(duration(1020), "17 min");
  EXPECT_EQ(duration(7500), "2 h 5 min");
  EXPECT_EQ(bar(0), "[............]");
  EXPECT_EQ(bar(0.5), "[######......]");
  EXPECT_EQ(bar(1.5, 3), "[###]");
}

// Texts of others do nothing to the terminal, and numbers of others nothing to the view.
TEST(StatusScreenTest, ShowsWhatStrangersSayAsText) {
  TrainingStatus wild = status();
  WorkerReport worker_of_them = worker("a\033[2J\nb", WorkerReport::REFUSED);
  worker_of_them.host = std::string(10000, 'h');
  worker_of_them.reason = "\a\xff\u202e" + std::string(10000, 'r');
  worker_of_them.silence = std::numeric_limits<double>::quiet_NaN();
  wild.worker_reports.assign(1000, worker_of_them);
  for (double number : {std::numeric_limits<double>::quiet_NaN(),
                        std::numeric_limits<double>::infinity(), -1e308}) {
    wild.steps_per_s = wild.mean_return = wild.time_left = number;
    const std::vector<std::string> lines = status_screen(wild, 0, kLarge);
    EXPECT_LE(lines.size(), kLarge.rows);
    for (const std::string& line : lines) {
      EXPECT_LT(line.size(), kLarge.columns);
      for (char c : line) EXPECT_GE(static_cast<unsigned char>(c), 0x20) << line;
    }
    EXPECT_EQ(status_line(wild, number).find('\033'), std::string::npos);
  }
  EXPECT_NE(status_screen(wild, 0, kLarge)[6].find("a\\x1b[2J\\nb"), std::string::npos);
}

}  // namespace
