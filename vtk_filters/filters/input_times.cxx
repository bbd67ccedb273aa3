// SPDX-License-Identifier: Apache-2.0
#include "input_times.h"

#include <functional>
#include <set>
#include <vector>

#include "vtkDataObject.h"
#include "vtkInformation.h"
#include "vtkInformationDoubleKey.h"
#include "vtkInformationVector.h"
#include "vtkStreamingDemandDrivenPipeline.h"

namespace anamorph_vtk {
namespace {

using Pipeline = vtkStreamingDemandDrivenPipeline;

void for_inputs(std::span<vtkInformationVector* const> inputs,
                const std::function<void(vtkInformation*)>& body) {
    for (vtkInformationVector* port : inputs)
        for (int i = 0; i < port->GetNumberOfInformationObjects(); ++i) body(port->GetInformationObject(i));
}

}  // namespace

void tell_times(std::span<vtkInformationVector* const> inputs, vtkInformation* output) {
    std::set<double> steps, ends;
    for_inputs(inputs, [&](vtkInformation* info) {
        const double *own_steps = info->Get(Pipeline::TIME_STEPS()),
                     *range = info->Get(Pipeline::TIME_RANGE());
        if (own_steps) steps.insert(own_steps, own_steps + info->Length(Pipeline::TIME_STEPS()));
        if (range) ends.insert(range, range + 2);
    });
    ends.insert(steps.begin(), steps.end());
    output->Remove(Pipeline::TIME_STEPS());
    output->Remove(Pipeline::TIME_RANGE());
    const std::vector<double> list(steps.begin(), steps.end());
    if (!list.empty()) output->Set(Pipeline::TIME_STEPS(), list.data(), static_cast<int>(list.size()));
    if (ends.empty()) return;
    const double range[] = {*ends.begin(), *ends.rbegin()};
    output->Set(Pipeline::TIME_RANGE(), range, 2);
}

void hand_over_time(std::span<vtkInformationVector* const> inputs, vtkDataObject* output) {
    vtkInformation* own = output->GetInformation();
    own->Remove(vtkDataObject::DATA_TIME_STEP());
    for_inputs(inputs, [&](vtkInformation* info) {
        vtkDataObject* data = info->Get(vtkDataObject::DATA_OBJECT());
        if (data && !own->Has(vtkDataObject::DATA_TIME_STEP()))
            own->CopyEntry(data->GetInformation(), vtkDataObject::DATA_TIME_STEP());
    });
}

}  // namespace anamorph_vtk
