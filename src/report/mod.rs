//! Pages and documents from facts handed over.
