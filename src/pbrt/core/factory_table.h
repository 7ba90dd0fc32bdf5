#pragma once
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "pbrt/core/param_reader.h"

namespace pbrt {

/// Documentation of one scene entity: light source "spot", material "hair".
struct FactoryDoc {
    std::string name, summary;  ///< the summary is a line of Markdown
    std::vector<ParamDoc> params;
};

/// Documentation of a family of entities: all light sources, all materials.
struct FamilyDoc {
    std::string name;       ///< as in `pbrt --list cameras`
    std::string what;       ///< noun for messages: `Camera`
    bool isPrefix = false;  ///< parameter names begin with the maker's name and a dot
    std::vector<FactoryDoc> makers;
};

/// Throws the error for an unknown name: `Camera "x" is unknown; ...`.
[[noreturn]] inline void ThrowUnknown(const std::string &what, const std::string &given,
                                      const std::vector<std::string> &names, const FileLoc &loc) {
    throw UserError(loc, "{} \"{}\" is unknown; {}{}.", what, Abbreviate(given), OldNameHint(what, given),
                    ListChoices(given, names));
}

/// Entities of one family by name, each with summary, declared parameters and a maker. The maker receives the parameter
/// struct, the ParamSet it was read from (for error locations), and the build context. Tables are filled by explicit
/// calls of Add.
///
/// If the context has a `sink`, unused parameters are reported to it; a member `before` is a ParamReader that has read
/// other parameters of the same set. Without a `sink`, parameters are called "entity.name" and share the set with other
/// entities; the owner of the set must report unused ones. `Traits`: further properties of each entity.
template <class Product, class Context, class Traits = std::monostate>
class FactoryTable {
    static constexpr bool kHasOwner = !requires(Context & c) { c.sink; };

  public:
    struct Entry : FactoryDoc {
        std::function<Product(const ParamSet &, Context &)> make;
        /// Set only if the context has no sink: throws the same errors for invalid values as `make`.
        std::function<void(const ParamSet &)> check;
        Traits traits;
    };

    /// `what`: noun for messages, for example `Camera`. `fill(table)` adds the entities.
    explicit FactoryTable(std::string what) : what_(std::move(what)) {}
    FactoryTable(std::string what, auto &&fill) : what_(std::move(what)) { fill(*this); }

    /// Throws std::logic_error (a program error) if the name is already registered.
    template <class P, class F>
    void Add(const std::string &name, std::string summary, F &&make, Traits traits = {}) {
        Entry entry{{name, std::move(summary), DocumentParams<P>()}, {}, {}, std::move(traits)};
        entry.make = [name, make = std::forward<F>(make)](const ParamSet &set, Context &context) -> Product {
            P p;
            ParamReader reader = ReaderOf(name, set, context);
            p.Describe(reader);
            if constexpr (kHasOwner) reader.ThrowIfErrors();
            else reader.Finish(context.sink);
            return make(std::move(p), set, context);
        };
        if constexpr (kHasOwner)
            entry.check = [name](const ParamSet &set) {
                P p;
                ReadParams(p, set, name);
            };
        if (!entries_.emplace(name, std::move(entry)).second)
            throw std::logic_error(fmt::format("{} \"{}\" is registered twice", what_, name));
    }

    bool Has(const std::string &name) const { return entries_.contains(name); }
    std::vector<std::string> Names() const {
        std::vector<std::string> names;
        for (const auto &[name, entry] : entries_) names.push_back(name);
        return names;
    }
    /// Throws UserError with the valid names if the name is unknown.
    const Entry &Find(const std::string &name, const FileLoc &loc = {}) const {
        auto it = entries_.find(name);
        if (it == entries_.end()) ThrowUnknown(what_, name, Names(), loc);
        return it->second;
    }
    Product Make(const std::string &name, const ParamSet &params, Context &context) const {
        return Find(name, params.Loc()).make(params, context);
    }
    FamilyDoc Document(std::string family) const {
        FamilyDoc doc{std::move(family), what_, kHasOwner, {}};
        for (const auto &[name, entry] : entries_) doc.makers.push_back(entry);
        return doc;
    }

  private:
    static ParamReader ReaderOf(const std::string &name, const ParamSet &set, Context &context) {
        if constexpr (requires { context.before; }) return ParamReader(set, context.before);
        else return ParamReader(set, kHasOwner ? name + '.' : "");
    }
    std::string what_;
    std::map<std::string, Entry> entries_;
};

/// Text of `pbrt --list NAME`: all entities of the family with their parameters and help lines.
std::string ListingOf(const FamilyDoc &family);
/// Table rows of docs/reference/compatibility.md: `| entity | parameters | remark |`.
std::string TableRowsOf(const FamilyDoc &family);

}  // namespace pbrt
