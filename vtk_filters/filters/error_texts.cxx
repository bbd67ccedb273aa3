// SPDX-License-Identifier: Apache-2.0
#include "error_texts.h"

#include "vtkCommand.h"

namespace anamorph_vtk {

class ErrorTexts::Listener : public vtkCommand {
  public:
    static Listener* New() { return new Listener; }
    void Execute(vtkObject*, unsigned long, void* text) override {
        if (!any && text) first = static_cast<const char*>(text);
        any = true;
    }
    bool any = false;
    std::string first;
};

ErrorTexts::ErrorTexts(vtkObject* object) : m_object(object), m_listener(vtkSmartPointer<Listener>::New()) {
    m_tag = object->AddObserver(vtkCommand::ErrorEvent, m_listener);
}

ErrorTexts::~ErrorTexts() {
    m_object->RemoveObserver(m_tag);
}

bool ErrorTexts::any() const {
    return m_listener->any;
}

std::string ErrorTexts::text() const {
    constexpr std::size_t kMost = 200;
    std::string text = m_listener->first;
    // VTK's: "ERROR: In FILE, line N\nvtkClass (0x...): what\n\n".
    if (const std::size_t at = text.find("): "); at != std::string::npos) text.erase(0, at + 3);
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
    if (text.size() > kMost) text.resize(kMost);
    return text.empty() ? "" : ": " + text;
}

}  // namespace anamorph_vtk
