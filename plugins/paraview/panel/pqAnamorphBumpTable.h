// SPDX-License-Identifier: Apache-2.0
/**
 * @class   pqAnamorphBumpTable
 * @brief   The table of bumps in the panel of Anamorph Deform.
 *
 * What ParaView's own table of numbers does not do: rows are counted from 0, as SelectedDeformation counts, whose row is marked, and a click
 * on a row's number selects that bump. Centre, extent and vector come first and are seen together in a narrow panel: numbers are as they
 * were typed where there is room, and have fewer digits where there is not (all of them in the tool tip, and where a cell is edited).
 */
#ifndef pqAnamorphBumpTable_h
#define pqAnamorphBumpTable_h

#include <QVariantList>

#include "pqPropertyWidget.h"

class QTableView;

class pqAnamorphBumpTable : public pqPropertyWidget {
    Q_OBJECT
    Q_PROPERTY(QVariantList numbers READ numbers WRITE setNumbers NOTIFY numbersChanged)
    Q_PROPERTY(int selected READ selected WRITE setSelected NOTIFY selectedChanged)

  public:
    pqAnamorphBumpTable(vtkSMProxy* proxy, vtkSMProperty* property, QWidget* parent = nullptr);

    QVariantList numbers() const;
    void setNumbers(const QVariantList& numbers);
    int selected() const;
    void setSelected(int row);

  Q_SIGNALS:
    void numbersChanged();
    void selectedChanged();

  protected:
    bool eventFilter(QObject* object, QEvent* event) override;
    void showEvent(QShowEvent* event) override;

  private:
    class Model;

    void addRow();
    void removeRows();
    void fit();

    Model* Rows;
    QTableView* Table;
    QWidget* Panel = nullptr;  ///< of which we are a part, as wide as it is seen
};

#endif
