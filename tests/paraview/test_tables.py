# SPDX-License-Identifier: Apache-2.0
# host: pvpython
"""ParaView reads the tables that programs write: one line of names, numbers as numbers."""
import csv
import os
import subprocess
import tempfile
import unittest

from paraview import servermanager
from paraview.simple import CSVReader
from vtkmodules.vtkIOInfovis import vtkDelimitedTextReader

MACHINE = os.environ["ANAMORPH_MACHINE"]


class Tables(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = os.path.join(folder.name, "schedule.csv")
        subprocess.run([MACHINE, "schedule", "--surface", "sphere", "--machine", "oka-1987:block=4,host_cycles=3000000",
                        "-o", self.path], check=True)
        with open(self.path) as file:
            self.rows = list(csv.DictReader(file))

    def check(self, table):
        names = list(self.rows[0])
        self.assertEqual([table.GetColumnName(i) for i in range(table.GetNumberOfColumns())], names)
        self.assertEqual(table.GetNumberOfRows(), 6)
        for name in names:
            column = table.GetColumnByName(name)
            values = [column.GetValue(i) for i in range(6)]
            if name == "stage":
                self.assertEqual(values, [row[name] for row in self.rows])
            else:
                self.assertTrue(column.IsNumeric(), name)
                self.assertEqual(values, [float(row[name]) for row in self.rows])
        self.assertEqual(table.GetColumnByName("utilisation").GetRange()[1], 1)

    def test_by_the_csv_reader(self):
        reader = CSVReader(FileName=[self.path])
        reader.UpdatePipeline()
        self.check(servermanager.Fetch(reader))

    def test_by_the_delimited_text_reader(self):
        reader = vtkDelimitedTextReader()
        reader.SetFileName(self.path)
        reader.SetFieldDelimiterCharacters(",")
        reader.SetHaveHeaders(True)
        reader.SetDetectNumericColumns(True)
        reader.Update()
        self.check(reader.GetOutput())


if __name__ == "__main__":
    unittest.main()
