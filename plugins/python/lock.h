// SPDX-License-Identifier: Apache-2.0
// Python's lock, let go of while C++ works. pybind11 has the same, but for a daemon thread that wants the lock when Python is at its end:
// Python before 3.14 unwinds such a thread, through destructors that must not throw, and the process aborts. Here it waits for the end of
// the process, as in 3.14.
#pragma once

#include <Python.h>

#include <chrono>
#include <thread>

namespace anamorph {

/// Calls what takes the lock, which throws nothing but what unwinds a thread.
template <class Take>
void take_lock(const Take& take) {
    try {
        take();
    } catch (...) {
        while (true) std::this_thread::sleep_for(std::chrono::hours(1));
    }
}

/// While it lives, its thread does not hold the lock.
class Unlocked {
  public:
    Unlocked() : m_state(PyEval_SaveThread()) {}
    ~Unlocked() {
        take_lock([this] { PyEval_RestoreThread(m_state); });
    }
    Unlocked(const Unlocked&) = delete;
    Unlocked& operator=(const Unlocked&) = delete;

  private:
    PyThreadState* m_state;
};

/// While it lives, its thread, which is unlocked, holds the lock.
class Locked {
  public:
    Locked() {
        take_lock([this] { m_state = PyGILState_Ensure(); });
    }
    ~Locked() { PyGILState_Release(m_state); }
    Locked(const Locked&) = delete;
    Locked& operator=(const Locked&) = delete;

  private:
    PyGILState_STATE m_state{};
};

}  // namespace anamorph
