// SPDX-License-Identifier: BSD-3-Clause
// Several ranks trace the bits of one, whoever runs which block, and whoever leaves before the end. Here ranks are
// threads; under mpirun they are tried by tests/tools/cluster/test_mpi.py.
#include "trace/run/ranks.hpp"

#include <deque>
#include <mutex>
#include <thread>

#include "base/errors.hpp"
#include "results/run_file/run_file.hpp"
#include "support/small_tube.hpp"

namespace straytrace::testing::trace_ranks {
namespace {

constexpr std::uint64_t blocks = 40;

struct Mail {
  std::mutex mutex;
  std::vector<std::deque<Transport::Message>> boxes;
  int answers = 0;  // to requests to replay scores
  bool answers_are_lost = false;
  std::string before_answers;  // another message in front of each
};

class ByMail final : public Transport {
 public:
  ByMail(Mail& mail, int rank) : mail_(mail), rank_(rank) {}
  int rank() const override { return rank_; }
  int size() const override { return int(mail_.boxes.size()); }
  void send(int to, std::string const& bytes) override {
    std::scoped_lock const lock(mail_.mutex);
    bool const answer = bytes.starts_with("scores");
    mail_.answers += answer;
    if (answer && !mail_.before_answers.empty()) mail_.boxes[std::size_t(to)].push_back({rank_, mail_.before_answers});
    if (answer && mail_.answers_are_lost) return;
    mail_.boxes[std::size_t(to)].push_back({rank_, bytes});
  }
  std::optional<Message> receive() override {
    std::scoped_lock const lock(mail_.mutex);
    auto& box = mail_.boxes[std::size_t(rank_)];
    if (box.empty()) return {};
    Message message = std::move(box.front());
    box.pop_front();
    return message;
  }
  void lost(int rank) override {
    ++losses;
    std::scoped_lock const lock(mail_.mutex);
    if (!said_late.empty()) mail_.boxes[std::size_t(rank_)].push_back({rank, said_late});
  }
  int losses = 0;
  std::string said_late;  // by a rank that was given up

 private:
  Mail& mail_;
  int rank_;
};

// The HDF5 library is for one thread at a time.
std::mutex hdf5_lock;
std::string packed(SumTree const& tree) {
  std::scoped_lock const lock(hdf5_lock);
  return nodes_image(tree);
}
SumTree unpacked(std::string const& bytes) {
  std::scoped_lock const lock(hdf5_lock);
  return nodes_of_image(bytes);
}

TraceSettings settings_for(unsigned threads) {
  TraceSettings settings;
  settings.histories = blocks * largest_block;
  settings.threads = threads;
  return settings;
}

// The cpu backend that notes how many blocks it ran, and may raise a flag after some.
class Counting final : public Backend {
 public:
  std::string_view name() const override { return "counting"; }
  BlockSums run_block(SteeredWorld const& world, std::uint64_t seed, std::uint64_t block) const override {
    if (++done == stop_after) stop = true;
    if (fail) throw NumericalError("the test wants it");
    return cpu_->run_block(world, seed, block);
  }
  mutable std::atomic<std::uint64_t> done{0};
  mutable std::atomic<bool> stop{false};
  std::uint64_t stop_after = 0;
  bool fail = false;

 private:
  std::unique_ptr<Backend> cpu_ = make_backend("cpu");
};

struct Job {
  explicit Job(int ranks) : backends(std::size_t(ranks)) { mail.boxes.resize(std::size_t(ranks)); }
  TraceResult run(TraceSettings settings) {
    std::vector<std::jthread> others;
    for (int rank = 1; rank < int(backends.size()); ++rank)
      others.emplace_back([this, rank, settings] {
        ByMail transport(mail, rank);
        TraceSettings mine = settings_for(settings.threads);
        mine.seed = settings.seed;
        mine.stop = &backends[std::size_t(rank)].stop;
        Ranks const ranks{transport, rank == stranger ? "another" : "same", packed, unpacked, patience};
        try {
          if (!asked.empty() && !(asked[std::size_t(rank)] = data_of_rank_0(ranks))) return;
          work_for_rank_0(SteeredWorld::as_given(world), mine, backends[std::size_t(rank)], ranks);
        } catch (std::exception const& e) {
          report_failure(transport, e.what());
        }
      });
    ByMail transport(mail, 0);
    Ranks ranks{transport, "same", packed, unpacked, patience};
    ranks.data = data;
    settings.ranks = &ranks;
    settings.stop = &backends[0].stop;
    TraceResult result = run_trace(SteeredWorld::as_given(world), settings, backends[0]);
    losses = transport.losses;
    return result;
  }
  Mail mail;
  std::vector<Counting> backends;
  World world = two_plates();
  double patience = 60;  // s
  int losses = 0;
  int stranger = 0;
  std::string data;
  std::vector<std::optional<std::string>> asked;  // by rank; empty: none asks
};

// Of all records.
std::vector<double> facts_of(CouplingTable const& table) {
  std::vector<double> facts;
  for (CouplingClass const& c : table.classes)
    for (PathRecord const& r : c.records) {
      facts.insert(facts.end(), {double(r.history), double(r.beam), r.coupling, r.weight, r.path_length});
      for (PhaseSensitivity const& p : r.phase_sensitivities) {
        facts.insert(facts.end(), std::begin(p.d), std::end(p.d));
        facts.insert(facts.end(), std::begin(p.moment), std::end(p.moment));
      }
    }
  return facts;
}

TEST(Ranks, AnyNumberOfThemIsOneRun) {
  TraceResult const one = run_trace(SteeredWorld::as_given(two_plates()), settings_for(1), *make_backend("cpu"));
  for (int const ranks : {1, 2, 4})
    for (unsigned const threads : {1u, 2u}) {
      Job job(ranks);
      TraceResult const r = job.run(settings_for(threads));
      EXPECT_TRUE(same(r.total, one.total)) << ranks << " ranks, " << threads << " threads";
      EXPECT_EQ(r.stopped, Stopped::by_histories);
      std::uint64_t done = 0;
      for (Counting const& backend : job.backends) done += backend.done;
      EXPECT_EQ(done, blocks);
      if (ranks > 1) {
        EXPECT_LT(job.backends[0].done, blocks);  // the others have worked too
      }
    }
  Job control(2);
  TraceSettings other = settings_for(1);
  other.seed = 2;
  EXPECT_FALSE(same(control.run(other).total, one.total));
}

// The records of a table hold what scores give when they are replayed. Controls: another score, a coupling that
// differs in its last bit.
TEST(Ranks, AllReplayScores) {
  TraceSettings settings = settings_for(1);
  settings.histories = 16 * largest_block;
  World const world = small_tube();
  TraceResult const one = run_trace(SteeredWorld::as_given(world), settings, *make_backend("cpu"));
  for (std::string const before : {"scores 99\nof another round", "failed\nthe test wants it"})
    for (bool const lost : {false, true}) {
      Job job(3);
      job.world = small_tube();
      job.mail.answers_are_lost = lost;
      job.mail.before_answers = before;
      if (lost) job.patience = 0.5;
      EXPECT_EQ(facts_of(job.run(settings).coupling), facts_of(one.coupling)) << before << ", lost: " << lost;
      EXPECT_GE(job.mail.answers, 1);
      EXPECT_EQ(job.losses > 0, before.starts_with("failed"));
    }
  std::vector<ScoreAddress> scores;
  for (auto const& [hash, sums] : one.total.classes) scores.insert(scores.end(), sums.kept.begin(), sums.kept.end());
  ASSERT_GT(scores.size(), 8192u);  // enough to be shared by two
  auto const replayed = [&] { return replay_scores(SteeredWorld::as_given(world), 1, scores, 2); };
  auto const first = replayed();
  EXPECT_GT(std::abs(first[0].path_length - first.back().path_length), 0);
  scores.back().coupling = std::nextafter(scores.back().coupling, 0);
  EXPECT_THROW(replayed(), NumericalError);
}

TEST(Ranks, StopRulesAreEvaluatedAtTheSameBlockCounts) {
  auto const looks = [](int ranks) {
    std::vector<std::uint64_t> seen;
    TraceSettings settings = settings_for(2);
    settings.histories = 200 * largest_block;
    settings.wanted_error = 1;
    settings.error = [&](CouplingTable const& table) {
      seen.push_back(table.histories / largest_block);
      return seen.size() < 2 ? 2 : 0.5;
    };
    Job job(ranks);
    TraceResult const r = job.run(settings);
    EXPECT_EQ(r.stopped, Stopped::by_error);
    EXPECT_EQ(r.total.blocks, seen.back());
    return seen;
  };
  EXPECT_EQ(looks(3), (std::vector<std::uint64_t>{32, 45, 64}));
}

// A rank that ends on a signal returns its unfinished blocks.
TEST(Ranks, OneMayLeave) {
  TraceResult const one = run_trace(SteeredWorld::as_given(two_plates()), settings_for(1), *make_backend("cpu"));
  Job job(3);
  job.backends[2].stop_after = 2;
  TraceResult const r = job.run(settings_for(1));
  EXPECT_TRUE(same(r.total, one.total));
  EXPECT_LE(job.backends[2].done, 3u);
}

// One that hangs (its node is gone, and nobody ended the job) costs its share of the work, not the run. When it comes
// back late, its sums are not counted twice.
TEST(Ranks, OneMayFallSilent) {
  TraceResult const one = run_trace(SteeredWorld::as_given(two_plates()), settings_for(1), *make_backend("cpu"));
  for (bool const comes_back : {false, true}) {
    Mail mail;
    mail.boxes.resize(2);
    ByMail here(mail, 0), there(mail, 1);
    World const world = two_plates();
    auto const cpu = make_backend("cpu");
    Ranks const ranks{here, "same", packed, unpacked, 0.2};
    if (comes_back) here.said_late = "sums 0 40\n" + packed(one.tree);
    there.send(0, "hello\nsame");
    TraceSettings settings = settings_for(1);
    settings.ranks = &ranks;
    TraceResult const r = run_trace(SteeredWorld::as_given(world), settings, *cpu);
    EXPECT_TRUE(same(r.total, one.total)) << comes_back;
    EXPECT_GE(here.losses, 1);
  }
}

// A lost rank is not waited for again when scores are replayed (control: AllReplayScores).
TEST(Ranks, OneThatIsLostReplaysNothing) {
  Mail mail;
  mail.boxes.resize(2);
  ByMail here(mail, 0), there(mail, 1);
  Ranks const ranks{here, "same", packed, unpacked, 0.2};
  there.send(0, "hello\nsame");
  TraceSettings settings = settings_for(1);
  settings.histories = 16 * largest_block;
  settings.ranks = &ranks;
  (void)run_trace(SteeredWorld::as_given(small_tube()), settings, *make_backend("cpu"));
  EXPECT_EQ(here.losses, 1);
  int orders = 0, replays = 0;
  for (auto const& message : mail.boxes[1]) {
    orders += message.bytes.starts_with("do");
    replays += message.bytes.starts_with("replay");
  }
  EXPECT_GE(orders, 1);
  EXPECT_EQ(replays, 0);
}

TEST(Ranks, InterruptedAndResumed) {
  TraceResult const one = run_trace(SteeredWorld::as_given(two_plates()), settings_for(1), *make_backend("cpu"));
  Job job(3);
  job.backends[0].stop_after = 2;
  TraceResult const part = job.run(settings_for(1));
  EXPECT_EQ(part.stopped, Stopped::by_signal);
  EXPECT_LT(part.total.blocks, blocks);
  std::uint64_t done = 0;
  for (Counting const& backend : job.backends) done += backend.done;
  EXPECT_EQ(part.total.blocks, done);  // nothing that was done is lost
  TraceSettings on = settings_for(2);
  on.resume = part.tree;
  EXPECT_TRUE(same(Job(2).run(on).total, one.total));
}

// Each rank gets what rank 0 has, before its work, whose sums are the same; a rank with another model gets nothing.
TEST(Ranks, DataOfRank0IsForAll) {
  TraceResult const one = Job(1).run(settings_for(2));
  Job job(3);
  job.data = std::string("a\nb\0c", 5);
  job.asked.resize(3);
  EXPECT_TRUE(same(job.run(settings_for(1)).total, one.total));
  EXPECT_EQ(job.asked[1], job.data);
  EXPECT_EQ(job.asked[2], job.data);
  Job mixed(2);
  mixed.data = job.data;
  mixed.asked.resize(2);
  mixed.stranger = 1;
  EXPECT_THROW(mixed.run(settings_for(1)), InputError);
  EXPECT_FALSE(mixed.asked[1]);
}

TEST(Ranks, FailuresAndStrangersEndTheJob) {
  Job failing(2);
  failing.backends[1].fail = true;
  try {
    failing.run(settings_for(1));
    FAIL() << "a rank has failed";
  } catch (NumericalError const& e) {
    EXPECT_NE(std::string(e.what()).find("rank 1 has failed: the test wants it"), std::string::npos) << e.what();
  }
  Job mixed(3);
  mixed.stranger = 2;
  EXPECT_THROW(mixed.run(settings_for(1)), InputError);
}

}  // namespace
}  // namespace straytrace::testing::trace_ranks
