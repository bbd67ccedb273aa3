// SPDX-License-Identifier: Apache-2.0
// What the tests of all filters share.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <vtkAlgorithm.h>
#include <vtkCommand.h>
#include <vtkDataArray.h>
#include <vtkDataObject.h>
#include <vtkExecutive.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPointSet.h>
#include <vtkPoints.h>
#include <vtkVersion.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInf = std::numeric_limits<double>::infinity();

/// Makes vtkSMPTools use a backend ("Sequential", "STDThread", "TBB" or, null, the one in use) and some
/// threads. False if there is no such backend.
bool use_threads(const char* backend, int threads);

/// Calls `body` with every backend that there is and 1, 2 and 4 threads.
inline void for_any_threads(const std::function<void()>& body) {
    int runs = 0;
    for (const char* backend : {"Sequential", "STDThread", "TBB"})
        for (const int threads : {1, 2, 4}) {
            if (!use_threads(backend, threads)) continue;
            SCOPED_TRACE(backend + std::to_string(threads));
            body();
            ++runs;
        }
    EXPECT_GE(runs, 6);
    use_threads("Sequential", 0);
}

/// A folder that lives as long as this.
class Folder {
  public:
    Folder() {
        static int count = 0;
        m_path = std::filesystem::temp_directory_path() /
                 ("anamorph_vtk_" + std::to_string(getpid()) + "_" + std::to_string(++count));
        std::filesystem::create_directories(m_path);
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(m_path, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    std::string path(const std::string& name) const { return (m_path / name).string(); }
    std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(path(name), std::ios::binary) << text;
        return path(name);
    }

  private:
    std::filesystem::path m_path;
};

/// Collects the errors (or warnings) of an object, of an algorithm's executive too, and keeps them from the
/// screen.
class Errors {
  public:
    explicit Errors(vtkObject* object, unsigned long event = vtkCommand::ErrorEvent) {
        m_observer->text = &m_text;
        object->AddObserver(event, m_observer);
        if (auto* algorithm = vtkAlgorithm::SafeDownCast(object))
            algorithm->GetExecutive()->AddObserver(event, m_observer);
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

/// The errors of a filter with an input (none, if null) and settings. After one the output has no points.
template <class Filter>
std::string errors_of(vtkDataObject* input, const std::function<void(Filter*)>& set = {}) {
    vtkNew<Filter> filter;
    Errors errors(filter);
    if (input) filter->SetInputDataObject(input);
    if (set) set(filter);
    filter->Update();
    EXPECT_TRUE(errors.text().empty() || filter->GetOutput()->GetNumberOfPoints() == 0);
    return errors.text();
}

/// Checks that each of the changes counts as a modification, and that none does when it is made again.
template <class Object>
void expect_modified_by(Object* object, const std::vector<std::function<void(Object*)>>& changes) {
    for (std::size_t i = 0; i < changes.size(); ++i) {
        SCOPED_TRACE(i);
        const vtkMTimeType before = object->GetMTime();
        changes[i](object);
        const vtkMTimeType after = object->GetMTime();
        EXPECT_GT(after, before);
        changes[i](object);
        EXPECT_EQ(object->GetMTime(), after);
    }
}

/// Checks that a second Update() does nothing.
inline void expect_executed_once(vtkAlgorithm* algorithm) {
    algorithm->Update();
    const vtkMTimeType made = algorithm->GetOutputDataObject(0)->GetMTime();
    algorithm->Update();
    EXPECT_EQ(algorithm->GetOutputDataObject(0)->GetMTime(), made);
}

inline void expect_printed(vtkObject* object, const std::vector<std::string>& parts) {
    std::ostringstream text;
    object->Print(text);
    for (const std::string& part : parts) EXPECT_THAT(text.str(), testing::HasSubstr(part));
}

/// A class that stands in another's place.
template <class Class>
class Override : public Class {
  public:
    static Override* New() { return new Override; }
    vtkTypeMacro(Override, Class);
};

template <class Class>
void expect_overridden(const char* name) {
    const OverrideFactory<Override<Class>> factory(name);
    EXPECT_STREQ(vtkNew<Class>()->GetClassName(), "Override");
}
