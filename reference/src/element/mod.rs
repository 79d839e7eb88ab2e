//! Hexahedral elements: stiffness and mass of one element.
