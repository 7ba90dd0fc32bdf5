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

/// What people are told of one kind of thing: light source "spot", material "hair" ...
struct FactoryDoc {
    std::string name, summary;  ///< the summary is a line of Markdown
    std::vector<ParamDoc> params;
};

/// What people are told of a family.
struct FamilyDoc {
    std::string name;       ///< as in `pbrt --list cameras`
    std::string what;       ///< as messages call one: `Camera`
    bool isPrefix = false;  ///< names of parameters begin with the maker's name and a dot
    std::vector<FactoryDoc> makers;
};

/// An error for a name that a family does not know: `Camera "x" is unknown; ...`.
[[noreturn]] void ThrowUnknown(const std::string &what, const std::string &given, const std::vector<std::string> &names,
                               const FileLoc &loc);

/// All kinds of things that a family has: by name, a summary, the declared parameters, and who makes one. The maker is
/// called with a parameter struct, the ParamSet that it was read from (for the places of complaints), and the context
/// of the build. Filled by explicit calls.
///
/// If the context has a `sink`, that takes unused parameters; if it has a `before`, that is a ParamReader that has read
/// other parameters of the same set. If it has no sink, parameters are called "thing.name" and stand among those of
/// others, so whoever has the set looks for unused ones. `Traits`: what else is to be known of each thing.
template <class Product, class Context, class Traits = std::monostate>
class FactoryTable {
    static constexpr bool kHasOwner = !requires(Context & c) { c.sink; };

  public:
    struct Entry : FactoryDoc {
        std::function<Product(const ParamSet &, Context &)> make;
        /// For a context without a sink: throws what `make` would throw for values that are wrong.
        std::function<void(const ParamSet &)> check;
        Traits traits;
    };

    /// `what`: as messages call such a thing, `Camera`.
    explicit FactoryTable(std::string what) : what_(std::move(what)) {}

    /// A name used twice is our error.
    template <class P, class F>
    void Add(const std::string &name, std::string summary, F &&make, Traits traits = {}) {
        Entry entry{{name, std::move(summary), DocumentParams<P>()}, {}, {}, std::move(traits)};
        entry.make = [name, make = std::forward<F>(make)](const ParamSet &set, Context &context) -> Product {
            P p;
            ParamReader reader = ReaderOf(name, set, context);
            p.Describe(reader);
            if constexpr (kHasOwner)
                reader.ThrowIfErrors();
            else
                reader.Finish(context.sink);
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
    /// Throws UserError with the choices if the name is unknown.
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
        if constexpr (requires { context.before; })
            return ParamReader(set, context.before);
        else
            return ParamReader(set, kHasOwner ? name + '.' : "");
    }
    std::string what_;
    std::map<std::string, Entry> entries_;
};

/// Text of `pbrt --list NAME`: every thing of the family with its parameters, a line each and their help.
std::string ListingOf(const FamilyDoc &family);
/// Rows of the tables of docs/compatibility.md: `| entity | parameters | remark |`.
std::string TableRowsOf(const FamilyDoc &family);

}  // namespace pbrt
