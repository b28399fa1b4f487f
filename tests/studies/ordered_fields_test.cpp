#include "studies/compare/ordered_fields.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

namespace gladstone {
namespace {

/// Field that is recognised by its number of columns.
DisplacementField numbered(std::size_t k) {
  DisplacementField field;
  field.columns = static_cast<int>(k);
  return field;
}

// Fields 2, 0, 1 are passed on as 0, 1, 2: field 2 waits for the others.
TEST(OrderedFields, ArePassedOnInTheirOrder) {
  std::vector<int> received;
  OrderedFields fields(3, [&](std::size_t k, DisplacementField const& field) {
    EXPECT_EQ(static_cast<int>(k), field.columns);
    received.push_back(field.columns);
  });
  fields.add(2, numbered(2));
  EXPECT_TRUE(received.empty());
  fields.add(0, numbered(0));
  EXPECT_EQ(received, (std::vector<int>{0}));
  fields.add(1, numbered(1));
  EXPECT_EQ(received, (std::vector<int>{0, 1, 2}));
}

// With a window of two, no field may be computed while two before it are missing. Four threads compute 200 fields; the
// difference between the field that begins and those received is never larger than the window.
TEST(OrderedFields, AreLimitedInNumber) {
  constexpr std::size_t window = 2, count = 200;
  std::atomic<std::size_t> next{0}, received{0}, most_ahead{0};
  OrderedFields fields(window, [&](std::size_t k, DisplacementField const&) { received = k + 1; });
  std::vector<std::thread> threads;
  for (int n = 0; n < 4; ++n)
    threads.emplace_back([&] {
      for (std::size_t k = next++; k < count && fields.wait_for(k); k = next++) {
        // Others may be received meanwhile, so that this is a lower bound of the difference at the beginning of k.
        std::size_t const before = received;
        if (k > before && k - before > most_ahead) most_ahead = k - before;
        fields.add(k, numbered(k));
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(received, count);
  EXPECT_LT(most_ahead, window);
}

// An exception ends the wait of the other threads, and the first one is rethrown.
TEST(OrderedFields, StopForAnException) {
  OrderedFields fields(1, [](std::size_t, DisplacementField const&) {});
  std::thread waiting([&] { EXPECT_FALSE(fields.wait_for(1)); });
  fields.stop(std::make_exception_ptr(std::runtime_error("disk full")));
  fields.stop(std::make_exception_ptr(std::logic_error("later")));
  waiting.join();
  EXPECT_FALSE(fields.wait_for(0));
  EXPECT_THROW(fields.throw_if_stopped(), std::runtime_error);
}

}  // namespace
}  // namespace gladstone
