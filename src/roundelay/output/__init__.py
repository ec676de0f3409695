"""What people and programs are shown: records, pictures, pages."""
