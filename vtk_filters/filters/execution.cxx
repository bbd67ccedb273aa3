// SPDX-License-Identifier: Apache-2.0
#include "execution.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <exception>
#include <mutex>
#include <new>

#include "smp_for.h"
#include "vtkAlgorithm.h"
#include "vtkDataObject.h"
#include "vtkInformation.h"
#include "vtkSmartPointer.h"

namespace anamorph_vtk {
namespace {

/// vtkAlgorithm::CheckAbort, or what there is of it in older versions.
template <class Algorithm>
bool is_aborted(Algorithm* algorithm) {
    if constexpr (requires { algorithm->CheckAbort(); })
        return algorithm->CheckAbort();
    else
        return algorithm->GetAbortExecute() != 0;
}

}  // namespace

void Execution::progress(double amount) {
    if (amount > m_progress) {
        m_progress = amount;
        m_algorithm->UpdateProgress(amount);
    }
    if (is_aborted(m_algorithm)) throw Aborted();
}

anamorph::ParallelFor Execution::stage(double begin, double end) {
    return [this, begin, end](std::int64_t count, const std::function<void(std::int64_t)>& body) {
        // The work is done in slices: observers are called from the filter's own thread alone.
        constexpr std::int64_t kSlices = 10, kLeastSlice = 32;
        const std::int64_t slice = std::max((count + kSlices - 1) / kSlices, kLeastSlice);
        std::atomic<bool> failed = false;
        std::exception_ptr failure;
        std::mutex guard;
        for (std::int64_t first = 0; first < count; first += slice) {
            const std::int64_t last = std::min(first + slice, count);
            anamorph::smp_for(last - first, [&](std::int64_t i) {
                if (failed) return;
                try {
                    body(first + i);
                } catch (...) {
                    const std::lock_guard<std::mutex> lock(guard);
                    if (!failure) failure = std::current_exception();
                    failed = true;
                }
            });
            if (failure) std::rethrow_exception(failure);
            progress(begin + (end - begin) * static_cast<double>(last) / static_cast<double>(count));
        }
    };
}

int guarded(vtkObject* object, const std::function<void()>& body,
            std::initializer_list<vtkDataObject*> outputs) {
    bool failed = true;
    try {
        body();
        return 1;
    } catch (const Aborted&) {
        failed = false;
    } catch (const std::bad_alloc&) {
        vtkErrorWithObjectMacro(object, << "not enough memory");
    } catch (const std::exception& error) {
        vtkErrorWithObjectMacro(object, << error.what());
    }
    for (vtkDataObject* output : outputs)
        if (output) output->Initialize();
    return failed ? 0 : 1;
}

bool has_inputs(vtkAlgorithm* filter, std::initializer_list<const char*> names) {
    int port = 0;
    for (const char* name : names) {
        if (filter->GetNumberOfInputConnections(port) == 0) {
            vtkErrorWithObjectMacro(filter,
                                    << name << " is not given: input port " << port << " must be connected");
            return false;
        }
        ++port;
    }
    return true;
}

void make_output(vtkInformation* output, vtkDataObject* like) {
    vtkDataObject* there = vtkDataObject::GetData(output);
    if (there && std::strcmp(there->GetClassName(), like->GetClassName()) == 0) return;
    output->Set(vtkDataObject::DATA_OBJECT(), vtkSmartPointer<vtkDataObject>::Take(like->NewInstance()));
}

}  // namespace anamorph_vtk
