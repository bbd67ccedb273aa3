// SPDX-License-Identifier: Apache-2.0
#include "block_looks.h"

#include <functional>

#include "vtkCompositeDataDisplayAttributes.h"
#include "vtkDataObject.h"
#include "vtkDataObjectTree.h"
#include "vtkDataObjectTreeIterator.h"
#include "vtkSmartPointer.h"

namespace anamorph_vtk {
namespace {

/// The nodes of a tree but its root, each before those that are in it.
void for_nodes(vtkDataObjectTree* tree, bool only_leaves, const std::function<void(vtkDataObject*)>& body) {
    const auto nodes = vtkSmartPointer<vtkDataObjectTreeIterator>::Take(tree->NewTreeIterator());
    nodes->SetVisitOnlyLeaves(only_leaves);
    for (nodes->InitTraversal(); !nodes->IsDoneWithTraversal(); nodes->GoToNextItem())
        body(nodes->GetCurrentDataObject());
}

}  // namespace

std::map<vtkDataObject*, BlockLook> block_looks(vtkDataObject* data,
                                                vtkCompositeDataDisplayAttributes* attributes) {
    std::map<vtkDataObject*, BlockLook> looks;
    auto* tree = vtkDataObjectTree::SafeDownCast(data);
    if (!tree || !attributes) return looks;
    const auto say = [&](vtkDataObject* node) {
        const bool shows = attributes->HasBlockVisibility(node), colors = attributes->HasBlockColor(node),
                   fades = attributes->HasBlockOpacity(node);
        if (!shows && !colors && !fades) return;
        const auto say_of = [&](vtkDataObject* leaf) {
            BlockLook& look = looks[leaf];
            if (shows) look.visible = attributes->GetBlockVisibility(node);
            if (colors) attributes->GetBlockColor(node, look.color.emplace().data());
            if (fades) look.opacity = attributes->GetBlockOpacity(node);
        };
        if (auto* branch = vtkDataObjectTree::SafeDownCast(node))
            for_nodes(branch, true, say_of);
        else
            say_of(node);
    };
    say(tree);
    for_nodes(tree, false, say);
    std::erase_if(looks, [](const auto& entry) { return entry.second.is_plain(); });
    return looks;
}

}  // namespace anamorph_vtk
