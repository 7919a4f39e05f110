// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/fields.h>
#include <Hexaplast/releases.h>
#include <sofa/helper/OptionsGroup.h>

#include <locale>
#include <optional>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

#include "attributes/admissible.hpp"
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

/// A word. Of one that it does not have, an OptionsGroup warns, and keeps the word before; this one remembers what it
/// was given, so that its component can refuse it.
class DataWord final : public Data<OptionsGroup>
{
public:
    explicit DataWord(const InitData& init) : Data<OptionsGroup>(init) {}

    bool read(const std::string& text) override
    {
        const bool is_read = Data<OptionsGroup>::read(text);
        m_read = text;
        m_counterRead = getCounter();
        return is_read;
    }

    /// The word that it was given latest, whether it has it or not.
    std::string given() const
    {
        const std::string& selected = getValue().getSelectedItem();
        return m_counterRead == getCounter() ? m_read : selected;
    }

private:
    std::string m_read;
    int m_counterRead = -1;
};

/// The group of a member of Material or Settings; that of none is empty.
inline std::string group_of(std::string_view name)
{
    if (const auto* row = find_row(material_rows(), name, Names::kScenes)) return std::string(row->group);
    if (const auto* row = find_row(settings_rows(), name, Names::kScenes)) return std::string(row->group);
    return {};
}

inline std::string help_of(const Attribute& attribute)
{
    std::string help(attribute.help);
    if (!attribute.words.empty()) help += fmt::format(" One of: {}.", attribute.words);
    if (const std::string range = attributes::describe(attribute.range); !range.empty())
        help += fmt::format(" It {}.", range);
    if (!attribute.unit.empty()) help += fmt::format(" [{}]", attribute.unit);
    return help;
}

template <class T>
T initial_value(const Attribute& attribute)
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

/// What a Data of a component is made from.
template <class T>
typename Data<T>::InitData from_table(SofaComponent& owner, Data<T>& data, const Attribute& attribute,
                                      const char* group)
{
    const bool is_output = attribute.access == attributes::Access::kOutput;
    auto init = owner.initData(&data, initial_value<T>(attribute), std::string(attribute.name).c_str(),
                               help_of(attribute).c_str(), true, is_output);
    init.group = is_output ? "Outputs" : group;
    return init;
}

/// An option of a part from the Data that has its name.
template <class T>
void read_option(const sofa::core::BaseData& data, const Attribute& attribute, T& option)
{
    using namespace sofa::type;
    const auto is = [&]<class Of>(std::type_identity<Of>) -> const Of&
    { return dynamic_cast<const Data<Of>&>(data).getValue(); };
    if constexpr (std::is_enum_v<T>)
        option = static_cast<T>(parts::place_of_word(attribute, dynamic_cast<const DataWord&>(data).given()));
    else if constexpr (std::is_same_v<T, hexaplast::Vec3>)
        option = vec3(is(std::type_identity<sofa::type::Vec3>()));
    else if constexpr (std::is_same_v<T, std::vector<double>>)
        option = reals(is(std::type_identity<vector<SReal>>()));
    else if constexpr (std::is_same_v<T, std::vector<int>>)
        option = whole_numbers(is(std::type_identity<vector<sofa::Index>>()));
    else if constexpr (std::is_same_v<T, PointArray>)
        option = view(is(std::type_identity<vector<sofa::type::Vec3>>()));
    else if constexpr (std::is_same_v<T, std::vector<Triangle>>)
        option = triangles(is(std::type_identity<MeshTopology::SeqTriangles>()));
    else
        option = is(std::type_identity<T>());
}
template <class T>
void read_option(const sofa::core::BaseData& data, const Attribute& attribute, std::optional<T>& option)
{
    if (data.isSet()) read_option(data, attribute, option.emplace());
}

/// The options of a part from the Data of its component. Throws OptionError for a word that there is not, with what
/// else is wrong.
template <class Options>
Options read_options(const SofaComponent& owner, const Description& description)
{
    Options options;
    parts::OptionErrors errors;
    Options::each(options,
                  [&](std::string_view option, auto& member)
                  {
                      const std::string name = parts::attribute_name(option);
                      errors.collect(
                          [&]
                          { read_option(*owner.findData(name), attributes::attribute_of(description, name), member); });
                  });
    if (errors.empty()) return options;
    errors.collect([&] { parts::OptionRanges(description, options).throw_all(); });
    errors.throw_all();
    return options;
}

/// A component whose Data are attributes of a table.
template <class TBase>
class TableComponent : public TBase
{
public:
    SOFA_ABSTRACT_CLASS(SOFA_TEMPLATE(TableComponent, TBase), TBase);

protected:
    explicit TableComponent(const Description& description) : m_description(description) {}

    const Description& description() const { return m_description; }

    /// What a Data is made from: Data<SReal> d_length{this->fromTable(d_length, "length")}. `group`: under which
    /// windows show it, where it is no member of Material or Settings and no output.
    template <class T>
    typename Data<T>::InitData fromTable(Data<T>& data, std::string_view name, const char* group = "")
    {
        const std::string of_row = group_of(name);
        return from_table(*this, data, attributes::attribute_of(m_description, name),
                          of_row.empty() ? group : of_row.c_str());
    }

    /// For links, which SOFA makes in the class that has them: l_body{initLink("body", helpOf("body"))}.
    const char* helpOf(std::string_view name) const
    {
        return attributes::attribute_of(m_description, name).help.data();
    }

    /// The options of a part from the Data. Throws OptionError.
    template <class Options>
    Options readOptions() const
    {
        return read_options<Options>(*this, m_description);
    }

private:
    const Description& m_description;
};

/// The inputs of a component that has the attributes of a table: whether a value changed since they were seen last.
class Inputs
{
public:
    Inputs(const SofaComponent& owner, const Description& description)
    {
        for (const Attribute& attribute : description.attributes)
            if (const auto* data = owner.findData(std::string(attribute.name)))
                if (attribute.access != attributes::Access::kOutput) m_data.push_back({data, data->getCounter()});
    }

    bool have_changed()
    {
        bool changed = false;
        for (auto& [data, counter] : m_data)
        {
            data->updateIfDirty();  // where it follows another one
            changed = changed || counter != data->getCounter();
            counter = data->getCounter();
        }
        return changed;
    }

private:
    struct Seen
    {
        const sofa::core::BaseData* data;
        int counter;
    };
    std::vector<Seen> m_data;
};

}  // namespace hexaplast::sofa_plugin
