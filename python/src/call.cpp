#include "python/src/call.h"

#include <nanobind/stl/string.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "python/src/warnings.h"
#include "render/base/interrupt.h"
#include "render/base/progress.h"
#include "studies/case/warning_log.h"

namespace gladstone::python {
namespace {

/// Messages that the library logs during one call from Python.
class CallMessages {
 public:
  /// @param message  a warning, or the text of another message
  void add(std::variant<Warning, std::string> message) {
    std::lock_guard const lock(mutex_);
    all_.push_back(std::move(message));
  }

  /// Passes the messages to Python. @pre the GIL is held
  void deliver() {
    std::vector<std::variant<Warning, std::string>> all;
    {
      std::lock_guard const lock(mutex_);
      all.swap(all_);
    }
    if (all.empty()) return;
    nb::object const deliver_to_python = nb::module_::import_("gladstone._messages").attr("deliver");
    nb::list messages;
    for (auto const& message : all) {
      auto const* const text = std::get_if<std::string>(&message);
      messages.append(text ? nb::object(nb::str(text->data(), text->size()))
                           : warning_text(std::get<Warning>(message)));
    }
    deliver_to_python(messages);
  }

 private:
  std::mutex mutex_;
  std::vector<std::variant<Warning, std::string>> all_;
};

/// Returns the messages of threads that belong to no call, such as workers of a parallel loop. The call that ends next
/// delivers them.
CallMessages& unassigned_messages() {
  static CallMessages all;
  return all;
}

thread_local CallMessages* messages_of_thread = nullptr;

class PythonSink final : public spdlog::sinks::base_sink<std::mutex> {
 private:
  void sink_it_(spdlog::details::log_msg const& message) override {
    CallMessages& all = messages_of_thread ? *messages_of_thread : unassigned_messages();
    if (Warning const* const warning = warning_being_logged()) {
      all.add(*warning);
    } else {
      all.add(std::string(message.payload.data(), message.payload.size()));
    }
  }
  void flush_() override {}
};

/// Number of calls that are running, so that the interrupt flag is cleared when the last one ends.
class RunningCalls {
 public:
  void begin() {
    std::lock_guard const lock(mutex_);
    ++count_;
  }
  void end() {
    std::lock_guard const lock(mutex_);
    if (--count_ == 0) clear_interrupt();
  }

 private:
  std::mutex mutex_;
  int count_ = 0;
};

RunningCalls running_calls;

/// State shared by the calling Python thread and the thread of the computation.
struct Call {
  CallMessages messages;
  ProgressMonitor monitor;
  std::mutex mutex;
  std::condition_variable ended;
  bool done = false;
  std::exception_ptr error;
};

void run_work(Call& call, std::function<void()> const& work) {
  messages_of_thread = &call.messages;
  ProgressMonitor::Scope const scope(call.monitor);
  try {
    work();
  } catch (...) {
    call.error = std::current_exception();
  }
  messages_of_thread = nullptr;
  std::lock_guard const lock(call.mutex);
  call.done = true;
  call.ended.notify_one();
}

void report_progress(ProgressMonitor const& monitor, nb::handle progress) {
  if (progress.is_none()) return;
  ProgressMonitor::Report const report = monitor.report();
  if (report.number == 0) return;
  progress(report.number, report.label, report.done, report.total);
}

}  // namespace

void route_log_to_python() {
  auto const log = std::make_shared<spdlog::logger>("gladstone", std::make_shared<PythonSink>());
  log->set_level(spdlog::level::info);
  spdlog::set_default_logger(log);
}

void run_released(std::function<void()> const& work, nb::handle progress) {
  Call call;
  running_calls.begin();
  std::thread thread(run_work, std::ref(call), std::cref(work));
  std::optional<nb::python_error> raised;  // exception raised by a signal handler or by `progress`
  auto const handle_signals_and_progress = [&] {
    if (raised) return;
    try {
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
      report_progress(call.monitor, progress);
    } catch (nb::python_error const& error) {
      raised.emplace(error);
      request_interrupt();
    }
  };
  {
    nb::gil_scoped_release const released;
    std::unique_lock lock(call.mutex);
    while (!call.ended.wait_for(lock, std::chrono::milliseconds(100), [&] { return call.done; })) {
      lock.unlock();
      {
        nb::gil_scoped_acquire const held;
        handle_signals_and_progress();
      }
      lock.lock();
    }
    lock.unlock();
    thread.join();
  }
  running_calls.end();
  if (raised) throw nb::python_error(*raised);
  report_progress(call.monitor, progress);
  call.messages.deliver();
  unassigned_messages().deliver();
  if (call.error) std::rethrow_exception(call.error);
}

}  // namespace gladstone::python
