// The door between Python and call.hpp. A call works in a thread of its own, without the interpreter's lock; the thread that
// called waits, looks for signals (so Ctrl-C ends long work wherever Python would notice it) and passes on progress.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <new>
#include <optional>
#include <thread>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "base/version.hpp"
#include "functions.hpp"

namespace py = pybind11;

namespace bodesmith::python {
namespace {

using Array = py::array_t<double, py::array::c_style>;

constexpr std::chrono::milliseconds kLookEvery{50};

/// What the working thread and the waiting one share.
struct Work {
  std::mutex mutex;
  std::condition_variable changed;
  bool done = false;
  std::atomic<double> fraction{0.0};
  Answer answer;
  std::exception_ptr error;
};

void work_on(Work& work, const Function& function, const Call& call) {
  try {
    const ProgressListener listener([&work](double fraction) { work.fraction.store(fraction); });
    work.answer = function.run(call);
  } catch (...) {
    work.error = std::current_exception();
  }
  const std::lock_guard lock(work.mutex);
  work.done = true;
  work.changed.notify_one();
}

bool wait_a_little(Work& work) {
  const py::gil_scoped_release release;
  std::unique_lock lock(work.mutex);
  return work.changed.wait_for(lock, kLookEvery, [&work] { return work.done; });
}

/// Waits for the end. What Python threw meanwhile (a signal, the callback) stops the work and is thrown behind it.
void wait_for(Work& work, const py::object& progress) {
  std::optional<py::error_already_set> thrown;
  double told = 0.0;
  while (!wait_a_little(work)) {
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      const double fraction = work.fraction.load();
      if (!thrown && !progress.is_none() && fraction > told) progress(told = fraction);
    } catch (py::error_already_set& error) {
      if (!thrown) thrown.emplace(error);
      ask_to_stop();
    }
  }
  if (!thrown) return;
  forget_interruption();
  throw py::error_already_set(*thrown);
}

/// Without the file that values from Python seem to come from, and the name under which a document is handed over.
std::string without_place(std::string text) {
  const std::string place = std::string(kNoFile) + ":", wrapping = "'document.";
  if (text.rfind(place, 0) != 0) return text;
  const std::size_t end = text.find(": ", place.size());
  if (end != std::string::npos) text.erase(0, end + 2);
  if (text.rfind(wrapping, 0) == 0) text.erase(1, wrapping.size() - 1);
  return text;
}

[[noreturn]] void throw_to_python(const char* type, const InputError& error) {
  const bool in_file = !error.file().empty() && error.file() != kNoFile;
  const py::object exception =
      py::module_::import("bodesmith.errors")
          .attr(type)(without_place(error.what()), in_file ? py::object(py::str(error.file())) : py::none(),
                      in_file && error.line() > 0 ? py::object(py::int_(error.line())) : py::none());
  PyErr_SetObject(py::type::of(exception).ptr(), exception.ptr());
  throw py::error_already_set();
}

void rethrow(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const DesignError& e) {
    throw_to_python("DesignError", e);
  } catch (const InputError& e) {
    throw_to_python("InputError", e);
  } catch (const Interrupted&) {
    PyErr_SetNone(PyExc_KeyboardInterrupt);
    throw py::error_already_set();
  } catch (const std::bad_alloc&) {
    PyErr_SetNone(PyExc_MemoryError);
    throw py::error_already_set();
  } catch (const std::exception& e) {
    PyErr_SetString(PyExc_RuntimeError,
                    (std::string("this is a bug, please report it: ") + e.what()).c_str());
    throw py::error_already_set();
  }
}

/// The vector's own memory as an array.
Array moved(std::vector<double>&& values) {
  auto* owned = new std::vector<double>(std::move(values));
  const py::capsule owner(owned, [](void* pointer) { delete static_cast<std::vector<double>*>(pointer); });
  return Array(static_cast<py::ssize_t>(owned->size()), owned->data(), owner);
}

const Function& function_named(const std::string& name) {
  for (const Function& function : functions()) {
    if (function.name == name) return function;
  }
  throw py::key_error(name);
}

/// (result as JSON text, arrays, files, warnings).
py::tuple call(const std::string& name, const std::string& options, const py::dict& arrays,
               const py::object& progress) {
  const Function& function = function_named(name);
  std::vector<Array> kept;  // as long as the work needs their memory
  std::optional<Call> given;
  try {
    given.emplace(Call{parse_json(options, kNoFile), {}});
  } catch (const InputError& error) {
    throw_to_python("InputError", error);
  }
  for (const auto& [key, value] : arrays) {
    kept.push_back(py::cast<Array>(value));
    given->arrays.emplace(py::cast<std::string>(key),
                          std::span(kept.back().data(), static_cast<std::size_t>(kept.back().size())));
  }
  Work work;
  std::thread worker(work_on, std::ref(work), std::cref(function), std::cref(*given));
  try {
    wait_for(work, progress);
  } catch (...) {
    worker.join();
    throw;
  }
  worker.join();
  if (work.error) rethrow(work.error);

  py::dict out_arrays, files;
  py::list warnings;
  for (auto& [key, values] : work.answer.arrays) out_arrays[py::str(key)] = moved(std::move(values));
  for (const auto& [path, text] : work.answer.files) files[py::str(path)] = py::str(text);
  for (const std::string& text : work.answer.warnings) warnings.append(py::str(text));
  return py::make_tuple(py::str(to_text(work.answer.result)), out_arrays, files, warnings);
}

}  // namespace
}  // namespace bodesmith::python

PYBIND11_MODULE(_core, m) {
  m.doc() = "What bodesmith computes, for the modules next to it.";
  m.attr("version") = bodesmith::kVersion;
  m.def("call", &bodesmith::python::call, py::arg("name"), py::arg("options"), py::arg("arrays"),
        py::arg("progress"));
}
