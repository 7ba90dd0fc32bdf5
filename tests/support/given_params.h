#pragma once
#include <memory>
#include <string>
#include <vector>

#include "pbrt/core/params.h"
#include "pbrt/math/vec.h"

namespace pbrt::test {

/// Parameters as a scene file would give them; line numbers count the parameters.
class Params {
  public:
    explicit Params(std::string what = "Entity \"test\"")
        : file_(std::make_shared<SourceFile>(SourceFile{"test.pbrt", ""})), set_(std::move(what), Loc(100)) {}
    Params &Floats(ParamType type, const std::string &name, std::vector<Float> v) {
        Param p = Make(type, name);
        p.floats = std::move(v);
        set_.Add(std::move(p));
        return *this;
    }
    Params &Integer(const std::string &name, int v) {
        Param p = Make(ParamType::Integer, name);
        p.ints = {v};
        set_.Add(std::move(p));
        return *this;
    }
    Params &Number(const std::string &name, Float v) { return Floats(ParamType::Float, name, {v}); }
    Params &Point(const std::string &name, Point3 v) { return Floats(ParamType::Point3, name, {v.x, v.y, v.z}); }
    Params &Rgb(const std::string &name, Float r, Float g, Float b) { return Floats(ParamType::Rgb, name, {r, g, b}); }
    Params &String(const std::string &name, std::string v) {
        Param p = Make(ParamType::String, name);
        p.strings = {std::move(v)};
        set_.Add(std::move(p));
        return *this;
    }
    Params &Bool(const std::string &name, bool v) {
        Param p = Make(ParamType::Bool, name);
        p.bools = {static_cast<uint8_t>(v)};
        set_.Add(std::move(p));
        return *this;
    }
    const ParamSet &Set() const { return set_; }
    operator const ParamSet &() const { return set_; }

  private:
    FileLoc Loc(int line) const { return {file_, line, 4}; }
    Param Make(ParamType type, const std::string &name) {
        Param p;
        p.type = type;
        p.name = name;
        p.loc = Loc(++lines_);
        return p;
    }
    std::shared_ptr<SourceFile> file_;
    int lines_ = 0;
    ParamSet set_;
};

}  // namespace pbrt::test
