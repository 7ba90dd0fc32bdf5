#include "pbrt/textures/texture_factory.h"

namespace pbrt {

namespace {

/// Parameter that names a texture; nullptr, and `*isValue` true, if a value (one of `types`) applies or nothing is
/// given.
const Param *TakeReference(ParamReader &reader, const std::string &name, std::initializer_list<ParamType> types,
                           bool *isValue) {
    const Param *own = nullptr;
    for (const Param &p : reader.Set().Own())
        if (p.name == name &&
            (p.type == ParamType::Texture || std::find(types.begin(), types.end(), p.type) != types.end()))
            own = &p;
    const Param *reference = own && own->type != ParamType::Texture ? nullptr : reader.Take(name, ParamType::Texture);
    *isValue = !reference;
    if (reference) detail::RequireCount(reader.Set(), *reference, reference->strings.size(), 1);
    return reference;
}

}  // namespace

void ReadParam(ParamReader &reader, const std::string &name, FloatTextureParam &value) {
    value.set = &reader.Set();
    bool isValue = false;
    value.given = TakeReference(reader, name, {ParamType::Float}, &isValue);
    if (!isValue) return;
    value.given = reader.Take(name, ParamType::Float);
    if (value.given) detail::RequireCount(*value.set, *value.given, value.given->floats.size(), 1);
}

void ReadParam(ParamReader &reader, const std::string &name, FloatTextureParam &value, const Range<Float> &range) {
    ReadParam(reader, name, value);
    value.range = range;
}

void ReadParam(ParamReader &reader, const std::string &name, SpectrumTextureParam &value) {
    value.set = &reader.Set();
    bool isValue = false;
    value.given = TakeReference(reader, name, {ParamType::Rgb, ParamType::Blackbody, ParamType::Spectrum}, &isValue);
    if (isValue) ReadParam(reader, name, static_cast<SpectrumParam &>(value));
}

void DocumentParam(ParamDoc &doc, const FloatTextureParam &value) {
    doc.types = {ParamType::Float, ParamType::Texture};
    if (value.constant) doc.defaultValue = fmt::format("{}", *value.constant);
}

void DocumentParam(ParamDoc &doc, const FloatTextureParam &value, const Range<Float> &range) {
    DocumentParam(doc, value);
    doc.range = ShortText(range);
}

void DocumentParam(ParamDoc &doc, const SpectrumTextureParam &value) {
    DocumentParam(doc, static_cast<const SpectrumParam &>(value));
    doc.types.push_back(ParamType::Texture);
}

}  // namespace pbrt
