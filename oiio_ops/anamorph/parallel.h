// SPDX-License-Identifier: Apache-2.0
// OpenImageIO's thread pools as the loop that the core asks for.
#pragma once

#include <OpenImageIO/thread.h>

#include "anamorph/error.h"

namespace anamorph {

/// A loop on the calling thread and up to `threads` - 1 of the pool's. The caller works on its own loop only
/// and waits for nobody but the workers that joined it, so loops may nest, and a pool without an idle thread
/// costs nothing. The pool must outlive the result. The first exception of a body is thrown again to the
/// caller.
ParallelFor parallel_for_on(OIIO::thread_pool& pool, int threads);

}  // namespace anamorph
