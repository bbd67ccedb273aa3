// SPDX-License-Identifier: Apache-2.0
// Image files opened by several threads at once.
#pragma once

#include <OpenImageIO/imageio.h>

#include <memory>
#include <mutex>
#include <string>

namespace anamorph {

/// Held while OpenImageIO opens a file that several threads may be opening others besides. OpenImageIO before 2.4.9 notes the words of each new ICC
/// profile in maps of the process without a lock, and crashes where two threads do. Recipes are opened without it: they
/// open files themselves, by several threads.
class OpeningLock {
  public:
    explicit OpeningLock(const std::string& name);

  private:
    std::unique_lock<std::mutex> m_lock;
};

/// OIIO::ImageInput::open, safe in several threads.
std::unique_ptr<OIIO::ImageInput> open_image(const std::string& name,
                                             const OIIO::ImageSpec* config = nullptr);

}  // namespace anamorph
