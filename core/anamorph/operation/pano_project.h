// SPDX-License-Identifier: Apache-2.0
// The operation pano with a project of Hugin as its source: one of its images, or all of them over each other.
#pragma once

#include <memory>

#include "anamorph/operation/operation.h"

namespace anamorph {

namespace rows {

/// The rows image, layers and feather.
ParameterTable project();

}  // namespace rows

/// Is the source a project?
bool is_of_project(const SideFiles& files);
/// Throws Error where a row is given that only projects have.
void refuse_rows_of_projects(const ParameterValues& values);
/// The images of the project that are drawn, in its order; none where the source is no project. Throws Error.
LinkedFiles images_of_project(const ParameterValues& values, const SideFiles& files,
                              const SideFileReader& reader);
/// The pictures of a project, whose images are the sources. Where nothing else is asked for, they show what its panorama does.
/// Throws Error.
std::unique_ptr<const Pictures> pictures_of_project(const OperationInput& input);

}  // namespace anamorph
