//! Steps that let a program write the matrices of a gear and its modes.

use std::io::{self, Write};

/// Program that solves a modal deck.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModalProgram {
    /// CalculiX.
    Calculix,
    /// Abaqus/Standard.
    Abaqus,
    /// Mechanical APDL of Ansys.
    Ansys,
}

impl ModalProgram {
    /// All programs with their names on the command line.
    pub const ALL: [(&'static str, Self); 3] = [
        ("calculix", Self::Calculix),
        ("abaqus", Self::Abaqus),
        ("ansys", Self::Ansys),
    ];
}

/// A modal analysis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModalRun {
    /// Program that solves the deck.
    pub program: ModalProgram,
    /// Number of modes with fixed bore.
    pub modes: u32,
    /// Beginning of the names of the files that Ansys writes; other programs take the name of the deck.
    pub stem: String,
}

impl ModalRun {
    /// Writes the steps of CalculiX or Abaqus: modes with fixed bore, and the matrices of the unconstrained body.
    ///
    /// CalculiX stops after it has stored matrices, so that this is its last step, which removes the conditions of the
    /// step before. In Abaqus it is the first step, which has no conditions yet.
    pub(super) fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let modes = self.modes;
        match self.program {
            ModalProgram::Calculix => write!(
                out,
                "*STEP\n*BOUNDARY\nbore, 1, 3\n*FREQUENCY, SOLVER=SPOOLES\n{modes}\n*NODE FILE\nU\n*END STEP\n\
                 *STEP\n*BOUNDARY, OP=NEW\n*FREQUENCY, SOLVER=MATRIXSTORAGE\n1\n*END STEP\n"
            ),
            ModalProgram::Abaqus => write!(
                out,
                "*STEP, NAME=matrices\n*MATRIX GENERATE, STIFFNESS, MASS\n\
                 *MATRIX OUTPUT, STIFFNESS, MASS, FORMAT=MATRIX INPUT\n*END STEP\n\
                 *STEP, NAME=modes\n*FREQUENCY, EIGENSOLVER=LANCZOS, NORMALIZATION=MASS\n{modes}\n\
                 *BOUNDARY\nbore, 1, 3\n*NODE PRINT, NSET=nall\nU1, U2, U3\n*END STEP\n"
            ),
            ModalProgram::Ansys => write!(
                out,
                "/SOLU\nANTYPE,MODAL\nMODOPT,LANB,{modes}\nSOLVE\nFINISH\n\
                 /AUX2\nFILE,,full\n\
                 HBMAT,{stem}_stiff,hb,,ASCII,STIFF,NO,YES\n\
                 HBMAT,{stem}_mass,hb,,ASCII,MASS,NO,NO\nFINISH\n",
                stem = self.stem
            ),
        }
    }
}
