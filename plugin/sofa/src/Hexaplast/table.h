// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/fields.h>
#include <Hexaplast/releases.h>
#include <sofa/core/objectmodel/BaseObjectDescription.h>
#include <sofa/helper/OptionsGroup.h>

#include <algorithm>
#include <functional>
#include <locale>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

#include "attributes/words.hpp"
#include "hexaplast/material/rows.hpp"
#include "parts/option.hpp"

/// Data as the attribute table describes them, so that names, defaults and help stand once for all hosts.
namespace hexaplast::sofa_plugin
{

using attributes::Attribute;
using attributes::Description;
using sofa::core::objectmodel::Data;
using sofa::helper::OptionsGroup;

inline std::string helpFrom(const Attribute& attribute)
{
    std::string help(attribute.help);
    if (!attribute.words.empty()) help += " One of: " + std::string(attribute.words) + ".";
    if (const std::string range = attributes::describe(attribute.range); !range.empty()) help += " It " + range + ".";
    if (!attribute.unit.empty()) help += " [" + std::string(attribute.unit) + "]";
    return help;
}

template <class T>
T initialValue(const Attribute& attribute)
{
    if constexpr (std::is_same_v<T, OptionsGroup>)
    {
        OptionsGroup words(attributes::split_words(attribute.words));
        words.setSelectedItem(std::string(attribute.initial));
        return words;
    }
    else
    {
        T value{};
        if (attribute.initial.empty()) return value;
        std::istringstream text{std::string(attribute.initial)};
        text.imbue(std::locale::classic());
        text >> std::boolalpha >> value;
        return value;
    }
}

/// The Data in which SOFA keeps an option or an output.
template <class T>
struct DataOf
{
    using type = Data<T>;
};
template <class T>
struct DataOf<std::optional<T>> : DataOf<T>
{
};
template <class T>
requires std::is_enum_v<T>
struct DataOf<T>
{
    using type = Data<OptionsGroup>;
};
template <>
struct DataOf<hexaplast::Vec3> : DataOf<sofa::type::Vec3>
{
};
template <>
struct DataOf<PointArray> : DataOf<sofa::type::vector<sofa::type::Vec3>>
{
};
template <>
struct DataOf<std::vector<double>> : DataOf<sofa::type::vector<SReal>>
{
};
template <>
struct DataOf<std::vector<int>> : DataOf<sofa::type::vector<sofa::Index>>
{
};
template <>
struct DataOf<std::span<const int>> : DataOf<sofa::type::vector<sofa::Index>>
{
};
template <>
struct DataOf<std::vector<Triangle>> : DataOf<MeshTopology::SeqTriangles>
{
};

/// What a Data of a component is made from. group: where the row has none.
template <class T>
typename Data<T>::InitData fromRow(SofaComponent& owner, Data<T>& data, const Attribute& attribute, const char* group)
{
    const bool isOutput = attribute.access == attributes::Access::kOutput;
    auto init = owner.initData(&data, initialValue<T>(attribute), std::string(attribute.name).c_str(),
                               helpFrom(attribute).c_str(), true, isOutput);
    init.group = isOutput ? "Outputs" : attribute.group.empty() ? group : std::string(attribute.group);
    return init;
}

/// An option of a part from the Data that has its name.
template <class T>
void readOption(const sofa::core::BaseData& data, T& option)
{
    const auto& given = dynamic_cast<const typename DataOf<T>::type&>(data);
    if constexpr (std::is_enum_v<T>)
        option = static_cast<T>(given.getValue().getSelectedId());
    else if constexpr (std::is_same_v<T, hexaplast::Vec3>)
        option = vec3(given.getValue());
    else if constexpr (std::is_same_v<T, std::vector<double>>)
        option = reals(given.getValue());
    else if constexpr (std::is_same_v<T, std::vector<int>>)
        option = wholeNumbers(given.getValue());
    else if constexpr (std::is_same_v<T, PointArray>)
        option = view(given.getValue());
    else if constexpr (std::is_same_v<T, std::vector<Triangle>>)
        option = triangles(given.getValue());
    else
        option = given.getValue();
}
template <class T>
void readOption(const sofa::core::BaseData& data, std::optional<T>& option)
{
    if (data.isSet()) readOption(data, option.emplace());
}

/// An output into the Data that has its name.
template <class T>
void writeOutput(sofa::core::BaseData& data, const T& output)
{
    auto& shown = dynamic_cast<typename DataOf<T>::type&>(data);
    if constexpr (std::is_same_v<T, hexaplast::Vec3>)
    {
        shown.setValue(vec3(output));
    }
    else if constexpr (std::is_same_v<T, PointArray>)
    {
        auto& points = *shown.beginWriteOnly();
        points.resize(static_cast<std::size_t>(output.rows()));
        view(points) = output;
        shown.endEdit();
    }
    else if constexpr (std::is_same_v<T, std::span<const int>> || std::is_same_v<T, std::vector<double>>)
    {
        shown.beginWriteOnly()->assign(output.begin(), output.end());
        shown.endEdit();
    }
    else
    {
        shown.setValue(output);
    }
}

/// A component whose Data are attributes of a table.
template <class TBase>
class TableComponent : public TBase
{
public:
    SOFA_ABSTRACT_CLASS(SOFA_TEMPLATE(TableComponent, TBase), TBase);

    /// SOFA warns of a word that an OptionsGroup has not, and of text that is no number, and goes on: here that is an
    /// error.
    void parse(sofa::core::objectmodel::BaseObjectDescription* given) override
    {
        TBase::parse(given);
        for (const Attribute& attribute : m_description.attributes)
        {
            const char* word = given->getAttribute(std::string(attribute.name));
            const auto* data = this->findData(std::string(attribute.name));
            if (!word || *word == '@' || !data) continue;
            if (attribute.words.empty() ? !holdsNumbers(attribute.type, word) : data->getValueString() != word)
                m_wrongWords[attribute.name] = {word, data->getCounter()};
        }
    }

protected:
    /// Makes a Data for each attribute that SOFA's own class has not, but for links, which SOFA makes in the class that
    /// has them: l_body{initLink("body", helpOf("body"))}. makesData: else makeData does, for a part. group: under
    /// which windows show what has none in the table.
    explicit TableComponent(const Description& description, const char* group = "", bool makesData = true)
        : m_description(description), m_group(group)
    {
        if (makesData) makeRest();
    }

    const Description& description() const { return m_description; }

    /// Throws OptionError where the scene gives this Data a word that it has not, or no number.
    void checkWord(std::string_view name) const
    {
        const auto wrong = m_wrongWords.find(name);
        if (wrong == m_wrongWords.end() || wrong->second.counter != this->findData(std::string(name))->getCounter())
            return;
        const Attribute& attribute = row(name);
        if (!attribute.words.empty()) parts::place_of_word(attribute, wrong->second.word);
        throw parts::OptionError(
            name, "= '" + wrong->second.word + "': must be " + std::string(attributes::describe(attribute.type)));
    }

    /// The Data of an attribute: Data<SReal>& d_length = data<SReal>("length").
    template <class T>
    Data<T>& data(std::string_view attribute) const
    {
        return dynamic_cast<Data<T>&>(*this->findData(std::string(attribute)));
    }

    /// Makes a Data for each option and each output of a part, as it has them there, and for what else is in the table.
    template <class Part>
    void makeData()
    {
        typename Part::Options options;
        Part::Options::each(options, [&](std::string_view option, const auto& member)
                            { make<std::remove_cvref_t<decltype(member)>>(row(parts::attribute_name(option))); });
        Part::outputs([&](std::string_view output, const auto& of)
                      { make<std::remove_cvref_t<std::invoke_result_t<decltype(of), const Part&>>>(row(output)); });
        makeRest();
    }

    const char* helpOf(std::string_view name) const { return row(name).help.data(); }

    /// The options of a part from the Data. Throws OptionError for a word that there is not, with what else is wrong.
    template <class Options>
    Options readOptions() const
    {
        Options options;
        parts::OptionErrors errors;
        Options::each(options,
                      [&](std::string_view option, auto& member)
                      {
                          const std::string name = parts::attribute_name(option);
                          readOption(*this->findData(name), member);
                          errors.collect([&] { checkWord(name); });
                      });
        if (errors.empty()) return options;
        errors.collect([&] { parts::OptionRanges(m_description, options).throw_all(); });
        errors.throw_all();
        return options;
    }

    /// Throws OptionError where a link is given that leads to nothing.
    template <class Link>
    static void checkLink(const Link& link, const char* name)
    {
        if (!link.get() && !link.getLinkedPath().empty())
            throw parts::OptionError(name, "'" + link.getLinkedPath() + "' leads to nothing");
    }

private:
    /// Whether all words of a text are numbers, or ranges of whole ones, where the type is one of numbers.
    static bool holdsNumbers(attributes::Type type, const std::string& text)
    {
        using attributes::Type;
        if (type == Type::kBool || type == Type::kText || type == Type::kWord || type == Type::kLink) return true;
        std::istringstream words(text);
        for (std::string word; words >> word;)
            if (word.find_first_not_of("0123456789+-.eEinfINFtyTYxX") != word.npos) return false;
        return true;
    }

    struct Owned
    {
        virtual ~Owned() = default;
    };
    template <class TData>
    struct OwnedData final : Owned
    {
        OwnedData(TableComponent& owner, const Attribute& attribute)
            : data(fromRow(owner, data, attribute, owner.m_group))
        {
        }
        TData data;
    };

    const Attribute& row(std::string_view attribute) const
    {
        return attributes::attribute_of(m_description, attribute);
    }

    template <class T>
    void make(const Attribute& attribute)
    {
        m_data.push_back(std::make_unique<OwnedData<typename DataOf<T>::type>>(*this, attribute));
    }

    void makeRest()
    {
        for (const Attribute& attribute : m_description.attributes)
            if (!this->findData(std::string(attribute.name))) makeByType(attribute);
    }
    void makeByType(const Attribute& attribute)
    {
        using attributes::Type;
        switch (attribute.type)
        {
            case Type::kBool:
                return make<bool>(attribute);
            case Type::kInteger:
                return make<int>(attribute);
            case Type::kReal:
                return make<SReal>(attribute);
            case Type::kVector3:
                return make<hexaplast::Vec3>(attribute);
            case Type::kIntegers:
                return make<std::vector<int>>(attribute);
            case Type::kReals:
                return make<std::vector<double>>(attribute);
            case Type::kVectors3:
                return make<PointArray>(attribute);
            case Type::kHexahedra:
                return make<MeshTopology::SeqHexahedra>(attribute);
            case Type::kText:
                return make<std::string>(attribute);
            case Type::kWord:
                return make<OptionsGroup>(attribute);
            case Type::kBoxes:  // none of ours has them
            case Type::kLink:
                return;
        }
    }

    struct WrongWord
    {
        std::string word;
        int counter;  // of the Data when it was given
    };

    const Description& m_description;
    const char* m_group;
    std::vector<std::unique_ptr<Owned>> m_data;
    std::map<std::string_view, WrongWord> m_wrongWords;  ///< by Data
};

}  // namespace hexaplast::sofa_plugin
