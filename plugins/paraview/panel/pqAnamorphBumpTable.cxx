// SPDX-License-Identifier: Apache-2.0
#include "pqAnamorphBumpTable.h"

#include <QAbstractScrollArea>
#include <QAbstractTableModel>
#include <QEvent>
#include <QFontMetrics>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QItemSelectionModel>
#include <QPalette>
#include <QScrollBar>
#include <QTableView>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>
#include <functional>
#include <initializer_list>
#include <set>

#include "number_text.h"
#include "vtkPVXMLElement.h"
#include "vtkSMProperty.h"
#include "vtkSMProxy.h"
#include "vtkSMVectorProperty.h"

namespace {

/// Centre, extent and vector across; then what most bumps do not have.
constexpr int kFirst[] = {0, 1, 3, 4, 6, 7, 8};
constexpr int kMostDigits = 6, kLeastDigits = 2;
constexpr int kRowsSeen = 10;  ///< before the table scrolls

/// As short as it can be told apart, or rounded to so many digits where that is longer.
QString text_of(double number, int digits) {
    const QString whole = number_text(number);
    const QString rounded = QString::number(number, 'g', digits);
    return whole.size() <= rounded.size() ? whole : rounded;
}

/// What the columns are called, by the hints of the property.
QStringList labels_of(vtkSMProperty* property) {
    QStringList labels;
    vtkPVXMLElement* const hints = property->GetHints();
    vtkPVXMLElement* const all = hints ? hints->FindNestedElementByName("ShowComponentLabels") : nullptr;
    for (unsigned int i = 0; all && i < all->GetNumberOfNestedElements(); ++i)
        labels.append(all->GetNestedElement(i)->GetAttributeOrDefault("label", ""));
    return labels;
}

}  // namespace

class pqAnamorphBumpTable::Model : public QAbstractTableModel {
  public:
    Model(const QStringList& labels, int columns, QObject* parent)
        : QAbstractTableModel(parent), m_labels(labels), m_columns(columns) {}

    int rowCount(const QModelIndex& /*parent*/ = QModelIndex()) const override {
        return static_cast<int>(m_numbers.size()) / m_columns;
    }
    int columnCount(const QModelIndex& /*parent*/ = QModelIndex()) const override { return m_columns; }
    Qt::ItemFlags flags(const QModelIndex& index) const override {
        return QAbstractTableModel::flags(index) | Qt::ItemIsEditable;
    }

    QVariant headerData(int section, Qt::Orientation orientation, int role) const override {
        if (role == Qt::DisplayRole)
            return orientation == Qt::Vertical ? QVariant(section) : QVariant(m_labels.value(section));
        if (role == Qt::ToolTipRole && orientation == Qt::Vertical)
            return tr("Click to select the bump: its handles are then in the view");
        return QVariant();
    }

    QVariant data(const QModelIndex& index, int role) const override {
        if (role == Qt::DisplayRole) return text_of(number(index.row(), index.column()), m_digits);
        if (role == Qt::ToolTipRole || role == Qt::EditRole)
            return number_text(number(index.row(), index.column()));
        if (index.row() == m_selected && role == Qt::BackgroundRole)
            return QPalette().brush(QPalette::Highlight);
        if (index.row() == m_selected && role == Qt::ForegroundRole)
            return QPalette().brush(QPalette::HighlightedText);
        return QVariant();
    }

    bool setData(const QModelIndex& index, const QVariant& value, int /*role*/) override {
        bool is_number = false;
        const double number = value.toString().toDouble(&is_number);
        QVariant& now = m_numbers[index.row() * m_columns + index.column()];
        if (!is_number || number == now.toDouble()) return false;
        now = number;
        Q_EMIT this->dataChanged(index, index);
        edited();
        return true;
    }

    double number(int row, int column) const { return m_numbers[row * m_columns + column].toDouble(); }
    const QVariantList& numbers() const { return m_numbers; }
    void set_numbers(const QVariantList& numbers) {
        const bool as_many = numbers.size() == m_numbers.size();
        if (!as_many) this->beginResetModel();
        m_numbers = numbers;
        if (!as_many) this->endResetModel();
        this->repaint();
    }

    int selected() const { return m_selected; }
    void set_selected(int row) {
        m_selected = row;
        this->repaint();
    }
    void set_digits(int digits) { m_digits = digits; }

    std::function<void()> edited;  ///< called when a cell has been

  private:
    void repaint() {
        if (this->rowCount() > 0)
            Q_EMIT this->dataChanged(this->index(0, 0), this->index(this->rowCount() - 1, m_columns - 1));
    }

    QStringList m_labels;
    int m_columns;
    QVariantList m_numbers;
    int m_selected = 0;
    int m_digits = kMostDigits;
};

pqAnamorphBumpTable::pqAnamorphBumpTable(vtkSMProxy* proxy, vtkSMProperty* property, QWidget* parent)
    : pqPropertyWidget(proxy, parent), Table(new QTableView(this)) {
    this->setShowLabel(false);
    const int columns = vtkSMVectorProperty::SafeDownCast(property)->GetNumberOfElementsPerCommand();
    this->Rows = new Model(labels_of(property), columns, this);
    this->Table->setObjectName("Table");
    this->Table->setModel(this->Rows);
    this->Table->setHorizontalScrollMode(QAbstractItemView::ScrollPerPixel);
    QHeaderView *const across = this->Table->horizontalHeader(), *const down = this->Table->verticalHeader();
    across->setMinimumSectionSize(1);
    across->setHighlightSections(false);
    for (int at = 0; at < static_cast<int>(std::size(kFirst)); ++at)
        across->moveSection(across->visualIndex(kFirst[at]), at);
    QFont small = this->Table->font();
    small.setPointSizeF(0.9 * small.pointSizeF());
    for (QWidget* widget : std::initializer_list<QWidget*>{this->Table, across, down}) widget->setFont(small);
    down->setDefaultSectionSize(QFontMetrics(small).height() + 6);
    this->Table->viewport()->installEventFilter(this);

    auto* const buttons = new QHBoxLayout;
    const auto add_button = [&](const QString& name, const QString& text, const QString& tip,
                                const std::function<void()>& pressed) {
        auto* const button = new QToolButton(this);
        button->setObjectName(name);
        button->setText(text);
        button->setToolTip(tip);
        QObject::connect(button, &QToolButton::clicked, this, pressed);
        buttons->addWidget(button);
    };
    add_button("Add", tr("Add"), tr("Adds a bump like the one of the current row"),
               [this] { this->addRow(); });
    add_button("Remove", tr("Remove"), tr("Removes the rows of which cells are marked"),
               [this] { this->removeRows(); });
    add_button("RemoveAll", tr("Remove all"), tr("Removes all bumps"), [this] {
        this->setNumbers({});
        Q_EMIT this->numbersChanged();
    });
    buttons->addStretch();
    auto* const layout = new QVBoxLayout(this);
    layout->setContentsMargins(0, 0, 0, 0);
    layout->addWidget(this->Table);
    layout->addLayout(buttons);

    QObject::connect(this->Rows, &QAbstractItemModel::dataChanged, this, [this] { this->fit(); });
    QObject::connect(this->Rows, &QAbstractItemModel::modelReset, this, [this] { this->fit(); });
    this->Rows->edited = [this] { Q_EMIT this->numbersChanged(); };
    QObject::connect(down, &QHeaderView::sectionClicked, this, [this](int row) {
        this->setSelected(row);
        Q_EMIT this->selectedChanged();
    });
    this->addPropertyLink(this, "numbers", SIGNAL(numbersChanged()), property);
    if (vtkSMProperty* const selected = proxy->GetProperty("SelectedDeformation"))
        this->addPropertyLink(this, "selected", SIGNAL(selectedChanged()), selected);
}

QVariantList pqAnamorphBumpTable::numbers() const {
    return this->Rows->numbers();
}
void pqAnamorphBumpTable::setNumbers(const QVariantList& numbers) {
    this->Rows->set_numbers(numbers);
    this->fit();
}
int pqAnamorphBumpTable::selected() const {
    return this->Rows->selected();
}
void pqAnamorphBumpTable::setSelected(int row) {
    this->Rows->set_selected(row);
}

void pqAnamorphBumpTable::addRow() {
    const int columns = this->Rows->columnCount(), rows = this->Rows->rowCount();
    if (rows == 0) {
        // The one that a new filter has; the table follows.
        this->proxy()->GetProperty("Deformations")->ResetToDomainDefaults();
    } else {
        const QModelIndex current = this->Table->currentIndex();
        const int after = current.isValid() ? current.row() : rows - 1;
        QVariantList numbers = this->numbers();
        const QVariantList like = numbers.mid(after * columns, columns);
        for (int c = 0; c < columns; ++c) numbers.insert((after + 1) * columns + c, like[c]);
        this->setNumbers(numbers);
        this->Table->setCurrentIndex(this->Rows->index(after + 1, 0));
    }
    Q_EMIT this->numbersChanged();
}

void pqAnamorphBumpTable::removeRows() {
    std::set<int> gone;
    for (const QModelIndex& index : this->Table->selectionModel()->selectedIndexes())
        gone.insert(index.row());
    if (gone.empty()) return;
    const int columns = this->Rows->columnCount();
    QVariantList left;
    for (int row = 0; row < this->Rows->rowCount(); ++row)
        if (gone.count(row) == 0) left += this->numbers().mid(row * columns, columns);
    this->setNumbers(left);
    Q_EMIT this->numbersChanged();
}

bool pqAnamorphBumpTable::eventFilter(QObject* object, QEvent* event) {
    if (event->type() == QEvent::Resize) this->fit();
    return pqPropertyWidget::eventFilter(object, event);
}

void pqAnamorphBumpTable::showEvent(QShowEvent* event) {
    // A panel is as wide as its widest part, and shows a part of that.
    for (QWidget* around = this->parentWidget(); around && !this->Panel; around = around->parentWidget())
        if (auto* const area = qobject_cast<QAbstractScrollArea*>(around)) this->Panel = area->viewport();
    if (this->Panel) this->Panel->installEventFilter(this);
    pqPropertyWidget::showEvent(event);
    this->fit();
}

/// Lets the columns of centre, extent and vector be seen together, by fewer digits if need be, and all rows up to a number of them.
void pqAnamorphBumpTable::fit() {
    QWidget* const cells = this->Table->viewport();
    const int left = this->Panel ? cells->mapTo(this->Panel->window(), QPoint()).x() -
                                       this->Panel->mapTo(this->Panel->window(), QPoint()).x()
                                 : 0;
    const int room = this->Panel ? std::min(cells->width(), this->Panel->width() - left) : cells->width();
    for (int digits = kMostDigits; digits >= kLeastDigits; --digits) {
        this->Rows->set_digits(digits);
        this->Table->resizeColumnsToContents();
        int taken = 0;
        for (const int column : kFirst) taken += this->Table->columnWidth(column);
        if (taken <= room) break;
    }
    const int lines = std::clamp(this->Rows->rowCount(), 1, kRowsSeen);
    this->Table->setFixedHeight(this->Table->horizontalHeader()->sizeHint().height() +
                                lines * this->Table->verticalHeader()->defaultSectionSize() +
                                this->Table->horizontalScrollBar()->sizeHint().height() +
                                2 * this->Table->frameWidth());
}
