#include "pbrt/build/light_sampler_spec.h"

#include <algorithm>
#include <charconv>
#include <sstream>

namespace pbrt {

namespace {

ParamType TypeOf(const ParamDoc &doc) {
    return doc.type == "integer"  ? ParamType::Integer
           : doc.type == "bool"   ? ParamType::Bool
           : doc.type == "string" ? ParamType::String
                                  : ParamType::Float;
}

/// What a flag says, for errors that show it.
class FlagText {
  public:
    FlagText(const char *flag, const std::string &text)
        : source_(std::make_shared<SourceFile>(SourceFile{flag, text})) {}
    const std::string &Text() const { return source_->text; }
    FileLoc At(size_t column) const { return {source_, 1, static_cast<int>(column)}; }

  private:
    std::shared_ptr<const SourceFile> source_;
};

/// A part of it: from one character up to another.
struct Piece {
    size_t begin = 0, end = 0;
    std::string Of(const std::string &text) const { return text.substr(begin, end - begin); }
};

struct Pieces {
    Piece sampler;
    bool mesh = false;
    std::optional<Piece> gate;
};

/// Where "+mesh", "+gate=" or another "+word" starts; numbers such as 1e+4 do not.
size_t FindSuffix(const std::string &text, size_t from) {
    for (size_t at = text.find('+', from); at != std::string::npos; at = text.find('+', at + 1))
        if (at + 1 < text.size() && std::isalpha(static_cast<unsigned char>(text[at + 1]))) return at;
    return text.size();
}

Pieces Split(const FlagText &flag, DiagnosticSink &sink) {
    static const std::string kGate = "gate=";
    const std::string &text = flag.Text();
    Pieces pieces;
    pieces.sampler = {0, FindSuffix(text, 0)};
    for (size_t at = pieces.sampler.end, end; at < text.size(); at = end) {
        end = FindSuffix(text, at + 1);
        const std::string word = text.substr(at + 1, end - at - 1);
        if (word == "mesh")
            pieces.mesh = true;
        else if (word.starts_with(kGate))
            pieces.gate = Piece{at + 1 + kGate.size(), end};
        else
            sink.Error(flag.At(at), fmt::format("\"+{}\" is unknown; a light sampler is written "
                                                "name[:key=value,...][+mesh][+gate=name[:key=value,...]].", word));
    }
    return pieces;
}

Param ReadOne(const FlagText &flag, const std::string &owner, const std::vector<ParamDoc> &docs, const Piece &piece) {
    const std::string item = piece.Of(flag.Text());
    const size_t equals = item.find('=');
    const std::string key = item.substr(0, equals);
    const ParamDoc *doc = nullptr;
    std::vector<std::string> keys;
    for (const ParamDoc &d : docs) {
        keys.push_back(d.name);
        if (d.name == key) doc = &d;
    }
    if (!doc)
        throw UserError(fmt::format("\"{}\" has no parameter \"{}\"; {}.", owner, key, ListChoices(key, keys)), flag.At(piece.begin));
    if (equals == std::string::npos) throw UserError(fmt::format("expected \"{}=value\".", key), flag.At(piece.begin));
    const std::string value = item.substr(equals + 1);
    Param p;
    p.name = owner + "." + key;
    p.loc = flag.At(piece.begin);
    p.type = TypeOf(*doc);
    bool good = false;
    auto number = [&](auto &out) {
        auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), out);
        return error == std::errc() && end == value.data() + value.size();
    };
    if (p.type == ParamType::Integer) {
        good = number(p.ints.emplace_back());
    } else if (p.type == ParamType::Bool) {
        p.bools.push_back(value == "true");
        good = value == "true" || value == "false";
    } else if (p.type == ParamType::String) {
        p.strings.push_back(value);
        good = true;
    } else {
        good = number(p.floats.emplace_back());
    }
    if (!good)
        throw UserError(fmt::format("\"{}\" is not a value of type {}.", value, doc->type), flag.At(piece.begin + equals + 1));
    return p;
}

/// "name:key=value,..." taken apart; `find(name, loc)` gives the registry's entry. All that is wrong with the keys is
/// reported; the entry comes back if the name is right.
template <class Find>
auto ReadPiece(const FlagText &flag, const Piece &piece, const Find &find, ParamSet *params, DiagnosticSink &sink)
    -> decltype(&find("", FileLoc())) {
    const std::string &text = flag.Text();
    const size_t colon = std::min(text.find(':', piece.begin), piece.end);
    try {
        const auto *entry = &find(text.substr(piece.begin, colon - piece.begin), flag.At(piece.begin));
        for (size_t begin = colon + 1; colon < piece.end && begin <= piece.end;) {
            const size_t end = std::min(text.find(',', begin), piece.end);
            try {
                params->Add(ReadOne(flag, entry->name, entry->params, {begin, end}));
            } catch (const UserError &e) {
                sink.Add(e);
            }
            begin = end + 1;
        }
        return entry;
    } catch (const UserError &e) {
        sink.Add(e);
        return nullptr;
    }
}

/// Marks the parameters "name.key" of an entry as known; those of the chosen one are copied.
void TakeParams(const ParamSet &integrator, const std::string &name, const std::vector<ParamDoc> &docs, ParamSet *chosen) {
    for (const ParamDoc &doc : docs) {
        const Param *p = integrator.Find(name + "." + doc.name, TypeOf(doc));
        if (p && chosen) chosen->Add(*p);
    }
}

/// The parameters of what was chosen: the integrator's, then the flag's, which win. Values out of range are errors.
template <class Entry>
ParamSet ChosenParams(const Entry &entry, const std::string &what, const ParamSet &integrator, const FileLoc &loc,
                      const ParamSet &added, DiagnosticSink &sink) {
    ParamSet params(fmt::format("{} \"{}\"", what, entry.name), loc);
    TakeParams(integrator, entry.name, entry.params, &params);
    for (const Param &p : added.Own()) params.Add(p);
    try {
        if (entry.check) entry.check(params);
    } catch (const UserError &e) {
        sink.Add(e);
    }
    return params;
}

std::vector<std::string> SplitChoices(const std::string &range) {
    std::vector<std::string> choices;
    std::istringstream in(range);
    for (std::string choice; in >> choice;) {
        if (choice.ends_with(',')) choice.pop_back();
        choices.push_back(choice);
    }
    return choices;
}

/// Warns of parameters that belong to another value of a choice such as "model": their help says so by beginning
/// with it, "paper: ...".
template <class Entry>
void WarnOfParamsWithoutEffect(const Entry &entry, const ParamSet &params, DiagnosticSink &sink) {
    for (const ParamDoc &choice : entry.params) {
        if (choice.type != "string") continue;
        const std::string chosen = params.GetString(entry.name + "." + choice.name, choice.defaultValue);
        for (const std::string &other : SplitChoices(choice.range))
            for (const ParamDoc &doc : entry.params)
                if (other != chosen && doc.name != choice.name && doc.help.starts_with(other + ": "))
                    if (const Param *p = params.Find(entry.name + "." + doc.name, TypeOf(doc)))
                        sink.Warning(p->loc, fmt::format("\"{}\" has no effect: it belongs to {}={}, and {} is \"{}\" here.",
                                                         doc.name, choice.name, other, choice.name, chosen));
    }
}

}  // namespace

LightChoiceParts SplitLightChoice(const std::string &choice, const char *flag) {
    DiagnosticSink sink;
    const Pieces pieces = Split(FlagText(flag, choice), sink);
    sink.ThrowIfErrors();
    LightChoiceParts parts{pieces.sampler.Of(choice), pieces.mesh, {}};
    if (pieces.gate) parts.gate = pieces.gate->Of(choice);
    return parts;
}

std::optional<LightSelection> ReadLightSelection(const ParamSet &integrator, const LightFlags &flags,
                                                 const LightSamplerRegistry &registry, DiagnosticSink &sink) {
    const size_t errorsBefore = sink.ErrorCount();
    auto collect = [&](auto &&read) {
        try {
            read();
        } catch (const UserError &e) {
            sink.Add(e);
        }
    };
    LightSelection selection;
    auto &[sampler, gate] = selection;
    const std::string name = integrator.GetString("lightsampler", "bvh"), gateName = integrator.GetString("shadowgate", "none");
    const bool meshOfScene = integrator.GetBool("meshlights", false);

    const FlagText choice(flags.choiceFlag, flags.choice), gateFlag(flags.gateFlag, flags.gate);
    const Pieces pieces = Split(choice, sink);
    ParamSet samplerKeys, gateKeys;
    auto findSampler = [&](const std::string &n, const FileLoc &loc) -> const auto & { return registry.Find(n, loc); };
    auto findGate = [&](const std::string &n, const FileLoc &loc) -> const auto & { return registry.FindGate(n, loc); };

    // What the scene says is looked at even where a flag beats it.
    collect([&] { sampler.entry = &registry.Find(name, integrator.LocOf("lightsampler")); });
    if (gateName != "none") collect([&] { gate.entry = &registry.FindGate(gateName, integrator.LocOf("shadowgate")); });
    if (!flags.choice.empty()) sampler.entry = ReadPiece(choice, pieces.sampler, findSampler, &samplerKeys, sink);
    const FlagText &gateText = pieces.gate ? choice : gateFlag;
    const Piece gatePiece = pieces.gate.value_or(Piece{0, flags.gate.size()});
    if (gatePiece.Of(gateText.Text()) == "none")
        gate.entry = nullptr;
    else if (pieces.gate || !flags.gate.empty())
        gate.entry = ReadPiece(gateText, gatePiece, findGate, &gateKeys, sink);

    // Keys of samplers that are registered but not chosen are accepted, so that a flag can switch.
    for (const std::string &known : registry.Names()) TakeParams(integrator, known, registry.Find(known).params, nullptr);
    for (const std::string &known : registry.GateNames()) TakeParams(integrator, known, registry.FindGate(known).params, nullptr);
    if (sampler.entry) {
        sampler.params = ChosenParams(*sampler.entry, "light sampler", integrator, integrator.LocOf("lightsampler"), samplerKeys, sink);
        WarnOfParamsWithoutEffect(*sampler.entry, sampler.params, sink);
    }
    if (gate.entry)
        gate.params = ChosenParams(*gate.entry, "shadow-ray gate", integrator, integrator.LocOf("shadowgate"), gateKeys, sink);

    sampler.meshLights = meshOfScene || flags.meshLights || pieces.mesh;
    // A sampler that groups by itself needs no wrapper.
    if (sampler.entry && !sampler.entry->takesGroups) sampler.meshLights = false;
    if (sink.ErrorCount() > errorsBefore) return {};
    return selection;
}

LightSelection ReadLightSelection(const std::string &choice, const LightSamplerRegistry &registry) {
    DiagnosticSink sink;
    LightFlags flags;
    flags.choice = choice;
    std::optional<LightSelection> selection = ReadLightSelection(ParamSet(), flags, registry, sink);
    sink.ThrowIfErrors();
    return *std::move(selection);
}

}  // namespace pbrt
