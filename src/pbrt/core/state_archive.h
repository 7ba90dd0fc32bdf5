#pragma once
#include "pbrt/core/state_io.h"

namespace pbrt {

/// Learned structures declare their members once, in `template <class Archive> void Visit(Archive &archive)`. It calls
/// archive(member, ...) for trivially copyable values, vectors of them, texts and structures with Visit. Indices and
/// offsets use archive.Structure(vector), see StateWriter::Structure. The archives are StateSaver and StateLoader.
class StateSaver {
  public:
    explicit StateSaver(StateWriter &out) : out_(out) {}
    template <class... T>
    void operator()(const T &...values) {
        (Save(values), ...);
    }
    template <class T>
    void Structure(const std::vector<T> &values) {
        out_.Structure(values);
    }

  private:
    template <class T>
    void Save(const T &value) {
        // Visit serves reading and writing, hence is not const; this archive changes nothing.
        if constexpr (requires(T & v, StateSaver & archive) { v.Visit(archive); }) const_cast<T &>(value).Visit(*this);
        else out_.Value(value);
    }
    template <class T>
    void Save(const std::vector<T> &values) {
        out_.Vector(values);
    }
    void Save(const std::string &text) { out_.Text(text); }

    StateWriter &out_;
};

/// Reads the output of StateSaver. Structures with `std::optional<std::string> Validate() const` (an error or none) are
/// validated once read. Throws UserError.
class StateLoader {
  public:
    explicit StateLoader(StateReader &in) : in_(in) {}
    template <class... T>
    void operator()(T &...values) {
        (Load(values), ...);
    }
    template <class T>
    void Structure(std::vector<T> &values) {
        in_.Structure(&values);
    }

  private:
    void Load(auto &value) {
        if constexpr (requires { value.Visit(*this); }) value.Visit(*this);
        else in_.Value(&value);
        if constexpr (requires { value.Validate(); }) in_.RequireValid(value.Validate());
    }
    template <class T>
    void Load(std::vector<T> &values) {
        in_.Vector(&values);
    }
    void Load(std::string &text) { text = in_.Text(); }

    StateReader &in_;
};

}  // namespace pbrt
