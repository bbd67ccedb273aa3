// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <iostream>

#include "anamorph/error.h"
#include "writers.h"

namespace anamorph::command {

struct OutputFile::Impl {
    std::string name;
    std::ofstream file;
    std::ostream& stream() { return name == "-" ? std::cout : file; }
    void check() {
        if (!stream()) throw Error("cannot write " + (name == "-" ? "to the standard output" : name));
    }
};

OutputFile::OutputFile(const std::string& name) : m_impl(std::make_unique<Impl>()) {
    m_impl->name = name;
    if (name != "-") m_impl->file.open(name, std::ios::binary);
    m_impl->check();
}

OutputFile::~OutputFile() = default;

void OutputFile::write(std::string_view text) {
    m_impl->stream().write(text.data(), static_cast<std::streamsize>(text.size()));
    m_impl->check();
}

void OutputFile::close() {
    m_impl->stream().flush();
    m_impl->check();
}

}  // namespace anamorph::command
