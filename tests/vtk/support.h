// SPDX-License-Identifier: Apache-2.0
// What the tests of all filters share.
#pragma once

#include <vtkAlgorithm.h>
#include <vtkCommand.h>
#include <vtkDataArray.h>
#include <vtkExecutive.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPointSet.h>
#include <vtkPoints.h>
#include <vtkVersion.h>

#include <string>
#include <vector>

/// vtkSMPTools with a backend ("Sequential", "STDThread", "TBB" or, null, the one in use) and some threads.
/// False if there is no such backend.
bool use_threads(const char* backend, int threads);

/// Collects the errors of an algorithm and of its executive, and keeps them from the screen.
class Errors {
  public:
    explicit Errors(vtkAlgorithm* algorithm) {
        m_observer->text = &m_text;
        algorithm->AddObserver(vtkCommand::ErrorEvent, m_observer);
        algorithm->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, m_observer);
    }
    const std::string& text() const { return m_text; }
    void clear() { m_text.clear(); }

  private:
    class Observer : public vtkCommand {
      public:
        static Observer* New() { return new Observer; }
        void Execute(vtkObject*, unsigned long, void* data) override {
            *text += static_cast<const char*>(data);
        }
        std::string* text = nullptr;
    };
    std::string m_text;
    vtkNew<Observer> m_observer;
};

/// Calls `body(progress)` at every report of progress.
class ProgressObserver : public vtkCommand {
  public:
    static ProgressObserver* New() { return new ProgressObserver; }
    void Execute(vtkObject*, unsigned long, void* data) override {
        reports.push_back(*static_cast<double*>(data));
        if (abort_at >= 0 && reports.back() >= abort_at) algorithm->SetAbortExecute(1);
    }
    std::vector<double> reports;
    vtkAlgorithm* algorithm = nullptr;
    double abort_at = -1;
};

/// All numbers of an array, as double.
inline std::vector<double> numbers(vtkDataArray* array) {
    std::vector<double> result;
    for (vtkIdType i = 0; array && i < array->GetNumberOfTuples(); ++i)
        for (int c = 0; c < array->GetNumberOfComponents(); ++c) result.push_back(array->GetComponent(i, c));
    return result;
}

inline std::vector<double> coordinates(vtkPointSet* points) {
    return points && points->GetPoints() ? numbers(points->GetPoints()->GetData()) : std::vector<double>();
}

#ifndef VTK_FUTURE_CONST  // before VTK 9.3
#define VTK_FUTURE_CONST
#endif

/// While it lives, New() of the class `name` makes a Class.
template <class Class>
class OverrideFactory {
  public:
    explicit OverrideFactory(const char* name) {
        m_factory->add(name);
        vtkObjectFactory::RegisterFactory(m_factory);
    }
    ~OverrideFactory() { vtkObjectFactory::UnRegisterFactory(m_factory); }
    OverrideFactory(const OverrideFactory&) = delete;
    OverrideFactory& operator=(const OverrideFactory&) = delete;

  private:
    class Factory : public vtkObjectFactory {
      public:
        static Factory* New() {
            auto* factory = new Factory;
            factory->InitializeObjectBase();
            return factory;
        }
        const char* GetVTKSourceVersion() VTK_FUTURE_CONST override { return VTK_SOURCE_VERSION; }
        const char* GetDescription() VTK_FUTURE_CONST override { return "test"; }
        void add(const char* name) {
            this->RegisterOverride(name, "Override", "", 1, []() -> vtkObject* { return Class::New(); });
        }
    };
    vtkNew<Factory> m_factory;
};
