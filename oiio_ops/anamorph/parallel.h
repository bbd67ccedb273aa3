// SPDX-License-Identifier: Apache-2.0
// OpenImageIO's thread pools as the loop that the core asks for.
#pragma once

#include <OpenImageIO/thread.h>

#include "anamorph/error.h"
#include "anamorph/parallel_for.h"

namespace anamorph {

/// A loop on the calling thread and up to `threads` - 1 of the pool's. The caller works on its own loop only
/// and waits for nobody but the workers that joined it, so loops may nest, and a pool without an idle thread
/// costs nothing. The pool must outlive the result. The first exception of a body is thrown again to the
/// caller.
ParallelFor parallel_for_on(OIIO::thread_pool& pool, int threads);

/// A loop on up to `threads` threads of OpenImageIO's default pool, the caller's among them; 0 for all of them.
ParallelFor default_parallel_for(int threads = 0);

/// While one lives, its thread counts as a worker of OpenImageIO's own pool, so that files it reads are
/// decoded on this thread alone. Otherwise it would wait for that pool and run the host's tasks meanwhile,
/// which may wait for the very tile that is being read. The workers of parallel_for_on always count so.
class PoolWorker {
  public:
    PoolWorker();
    ~PoolWorker();
    PoolWorker(const PoolWorker&) = delete;
    PoolWorker& operator=(const PoolWorker&) = delete;
};

}  // namespace anamorph
