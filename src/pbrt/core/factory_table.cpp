#include "pbrt/core/factory_table.h"

#include <regex>

namespace pbrt {

namespace {

/// Parameter type in words ("integer") or, if `isShort`, in letters ("i").
std::string TypeName(const ParamDoc &doc, bool isShort) {
    const auto has = [&](ParamType type) { return std::ranges::count(doc.types, type) > 0; };
    const bool isTexture = has(ParamType::Texture);
    auto pick = [&](const char *letters, const char *word) { return std::string(isShort ? letters : word); };
    if (has(ParamType::Spectrum)) {
        if (isTexture) return pick("st", "spectrum texture");
        return has(ParamType::Float) ? pick("f/sp", "float or spectrum") : pick("sp", "spectrum");
    }
    if (isTexture) return pick("ft", "float texture");
    static const std::map<ParamType, const char *> letters = {
        {ParamType::Integer, "i"}, {ParamType::Float, "f"},   {ParamType::Bool, "b"},     {ParamType::String, "s"},
        {ParamType::Point2, "p2"}, {ParamType::Point3, "p3"}, {ParamType::Vector3, "v3"}, {ParamType::Normal, "n"}};
    std::string name;
    for (ParamType type : doc.types) {
        if (!name.empty()) name += isShort ? "/" : " or ";
        name += isShort && letters.contains(type) ? letters.at(type) : Name(type);
    }
    return doc.isList ? name + "[]" : name;
}

/// A line of Markdown for a terminal. Anchors are those of docs/reference/compatibility.md.
std::string WithoutMarkup(const std::string &markdown) {
    static const std::regex kAnchor(R"(\[([^\]]*)\]\(#[^)]*\))"), kLink(R"(\[([^\]]*)\]\([^)]*\))"), kBold(R"(\*\*)");
    const std::string linked = std::regex_replace(markdown, kAnchor, "$1 in docs/reference/compatibility.md");
    return std::regex_replace(std::regex_replace(linked, kLink, "$1"), kBold, "");
}

}  // namespace

std::string ParamDoc::TypeText() const { return TypeName(*this, false); }
std::string ParamDoc::ShortType() const { return TypeName(*this, true); }

std::string ListingOf(const FamilyDoc &family) {
    std::string out;
    for (const FactoryDoc &maker : family.makers) {
        out += fmt::format("{}{}\n", out.empty() ? "" : "\n", maker.name);
        if (!maker.summary.empty()) out += fmt::format("    {}\n", WithoutMarkup(maker.summary));
        if (maker.params.empty()) out += "    No parameters.\n";
        for (const ParamDoc &p : maker.params) {
            out += fmt::format("    {} {}{}", p.TypeText(), family.isPrefix ? maker.name + '.' : "", p.name);
            if (!p.defaultValue.empty()) out += " = " + p.defaultValue;
            if (!p.range.empty()) out += " (" + p.range + ')';
            out += fmt::format("\n        {}\n", p.help);
        }
    }
    return out;
}

std::string TableRowsOf(const FamilyDoc &family) {
    std::string out;
    for (const FactoryDoc &maker : family.makers) {
        std::string params;
        for (const ParamDoc &p : maker.params)
            params += fmt::format("{}`{} {}`", params.empty() ? "" : ", ", p.ShortType(), p.name);
        out += fmt::format("| `{} \"{}\"` | {}{}|{} |\n", family.what, maker.name, params, params.empty() ? "" : " ",
                           maker.summary.empty() ? "" : ' ' + maker.summary);
    }
    return out;
}

}  // namespace pbrt
