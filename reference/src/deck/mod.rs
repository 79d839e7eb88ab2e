//! Abaqus and CalculiX decks (`.inp`): reading, checking, writing.
